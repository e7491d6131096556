(** ** Continuous time, with rules of switching: one form for each mode *)

Record place := Place { size : nat; law : flow; form : sym; dwell : Z * Z; gives : witness }.
(* How a form is followed through the shortest stay: so many pieces, with so many terms each, a
   little that is added, and a scale. *)
Record bridge := Bridge { number : BinNums.positive; terms : nat; more : Z; scale : Z }.
(* From a mode to a mode, by their places in the list, and what becomes of the state. *)
Record switch := Switch { from : nat; to : nat; reset : option linear; through : bridge }.

Section Switches.
Variables (p q factor : Z) (places : list place) (switches : list switch).
Notation alpha := (IZR p / IZR q).

(* The mode m is in force from zero to a time. *)
Definition stays (m : place) (w : R -> vec) (time : R) : Prop :=
  (forall k t, (k < size m)%nat -> 0 < t <= time -> continuity_pt (fun s => w s k) t)
  /\ (forall t, 0 <= t < time -> exists l, moves (size m) false [law m] [] w none l t).

(* From the state x, where the mode i begins, the state y, where the mode j begins, is reached after
   a time: stays in modes, and a switch after each. *)
Inductive reaches (i : nat) (x : vec) : R -> nat -> vec -> Prop :=
  | at_first : reaches i x 0 i x
  | after_stay time span s m w z :
      reaches i x time (from s) (w 0) -> In s switches -> nth_error places (from s) = Some m ->
      0 <= span -> IZR (fst (dwell m)) / IZR (snd (dwell m)) <= span -> stays m w span ->
      (forall k, z k = moved (reset s) (w span) k) -> reaches i x (time + span) (to s) z.

(* The form of the mode falls exponentially along every solution, and is no smaller than the squares
   of the states but for a factor. *)
Definition decays_by_mode : Prop :=
  forall i j x time m l w span,
  nth_error places i = Some m -> nth_error places j = Some l -> reaches i x time j (w 0) ->
  0 <= span -> stays l w span ->
  quad (form l) (w span) <= exp (- (2 * alpha) * (time + span)) * quad (form m) x
  /\ norm2 (size l) (w span) <= IZR factor * quad (form l) (w span).

Definition place_falls (m : place) : bool :=
  shaped (size m) (form m) && exceeds factor (form m)
  && flows_fall (size m) 1 p q (singles (size m)) (form m) [] factor false [law m] []
       (singles (size m)) [] [gives m] [].

(* Before the last of the shortest stay, and after the switch. *)
Definition bridged (m l : place) (s : switch) : bool :=
  let b := through s in
  let n := size m in
  let k := Zpos (number b) in
  let T := map (zrow (scale b)) (pulled_back (form l) (reset s)) in
  let u := under (reset s) in
  (0 <? fst (dwell m))%Z && (0 <? scale b)%Z && (0 <? u)%Z && (0 <? over (law m))%Z && (0 <? q)%Z
  && forallb (fun r => length r <=? n)%nat (rows (law m)) && shaped n T
  && match pieces n p q (fst (dwell m)) (snd (dwell m) * k) (law m) (Pos.to_nat (number b)) (terms
    b)
             (more b) (collected (expanded T (singles n))) with
     | Some P => nowhere_negative n (collected
         (pscale (scale b * u * u) (expanded (form m) (singles n)) ++ pscale (-1) P))
     | None => false
     end.

Definition switch_falls (s : switch) : bool :=
  match nth_error places (from s), nth_error places (to s) with
  | Some m, Some l =>
      (0 <=? fst (dwell m))%Z && (0 <? snd (dwell m))%Z
      && (if (fst (dwell m) =? 0)%Z then leads 1 1 (form m) (form l) (reset s) else bridged m l s)
  | _, _ => false
  end.

Definition switches_fall : bool := every place_falls places && every switch_falls switches.

Lemma stays_falls m w span : place_falls m = true -> 0 <= span -> stays m w span ->
  quad (form m) (w span) <= exp (- (2 * alpha) * span) * quad (form m) (w 0).
Proof.
  unfold place_falls. rewrite !andb_true_iff. intros [[S _] F] T [C M].
  pose proof (decays_sound _ _ _ _ _ _ _ _ _ _ _ _ _ _ _ F eq_refl w span T C M) as D.
  unfold seen in D. rewrite !V_singles in D by exact S.
  replace (2 * alpha) with (2 * INR 1 * alpha) by (simpl; ring). exact D.
Qed.

Lemma exp_sum a t u : exp (- a * (t + u)) = exp (- a * u) * exp (- a * t).
Proof. rewrite <- exp_plus. f_equal. ring. Qed.

Lemma average_of_one f z v l : average [f] z v l -> forall k, v k = field f z k.
Proof.
  intros H k. induction H as [g I | a v l u m _ _ IHv _ IHu].
  - destruct I as [<- | []]. reflexivity.
  - rewrite IHv, IHu. ring.
Qed.

(* From where the shortest stay before a switch begins to behind the switch. *)
Lemma bridged_sound m l s w span : place_falls m = true -> (0 < snd (dwell m))%Z ->
  bridged m l s = true -> stays m w span ->
  let time := IZR (fst (dwell m)) / IZR (snd (dwell m)) in time <= span ->
  quad (form l) (moved (reset s) (w span))
  <= exp (- (2 * alpha) * time) * quad (form m) (w (span - time)).
Proof.
  intros Pm D B [C M] time Span. unfold bridged in B. cbv zeta in B.
  rewrite !andb_true_iff, !Z.ltb_lt in B.
  destruct B as [[[[[[[Dw Sc] U] O] Q] Len] Sh] B].
  set (k := number (through s)) in *. set (T := map _ (pulled_back _ _)) in *.
  destruct (pieces _ _ _ _ _ _ _ _ _ _) as [P0 |] eqn:E; [| discriminate].
  assert (Hd : (0 < snd (dwell m) * Zpos k)%Z) by (apply Z.mul_pos_pos; [exact D | reflexivity]).
  assert (Time : INR (Pos.to_nat k) * (IZR (fst (dwell m)) / IZR (snd (dwell m) * Zpos k)) = time).
  { unfold time. rewrite INR_IZR_INZ, positive_nat_Z, mult_IZR.
    pose proof (IZR_lt 0 _ D). pose proof (IZR_lt 0 (Zpos k) eq_refl). field. lra. }
  assert (T0 : 0 < time) by (apply Rdiv_lt_0_compat; apply (IZR_lt 0); assumption).
  assert (F : flows_for (size m) (law m) w (span - time) time).
  { split.
    - intros j t J R. apply C; [exact J | lra].
    - intros j t J R. destruct (M t ltac:(lra)) as [l' [v A _ Dv |]]; [| discriminate].
      specialize (Dv j J). rewrite (average_of_one _ _ _ _ A) in Dv. unfold field in *.
      rewrite (dot_ext_below _ (w t) (joined (size m) (w t) none)); [exact Dv |].
      intros i K. unfold joined. rewrite (proj2 (Nat.ltb_lt i (size m))); [reflexivity |].
      destruct (nth_in_or_default j (rows (law m)) []) as [G | G].
      + apply (proj1 (forallb_forall _ _) Len), Nat.leb_le in G. lia.
      + rewrite G in K. simpl in K. lia. }
  pose proof (pieces_sound (size m) p q _ _ (law m) O Q Dw Hd _ _ _ _ _ w (span - time) E) as K.
  rewrite Time in K. specialize (K F).
  replace (span - time + time) with span in K by ring.
  rewrite peval_collected, peval_expanded in K.
  change (quad T (monomials (singles (size m)) (w span))) with (V (singles (size m)) T (w span))
    in K.
  rewrite V_singles in K by exact Sh. unfold T in K. rewrite quad_scale, quad_moved in K by exact U.
  apply (nowhere_negative_sound _ _ (w (span - time))) in B.
  rewrite peval_collected, peval_app, !peval_scale, peval_expanded in B.
  change (quad (form m) (monomials (singles (size m)) (w (span - time))))
    with (V (singles (size m)) (form m) (w (span - time))) in B.
  unfold place_falls in Pm. rewrite !andb_true_iff in Pm. destruct Pm as [[Sm _] _].
  rewrite V_singles, !mult_IZR in B by exact Sm.
  apply (IZR_lt 0) in Sc, U. set (sc := IZR (scale (through s))) in *. set (u := IZR (under _)) in
    *.
  set (e := exp _) in *. assert (0 < e) by apply exp_pos.
  set (v := quad (form m) _) in *. set (x := quad (form l) _) in *. set (y := peval P0 _) in *.
  apply Rmult_le_reg_l with (sc * u * u); [repeat apply Rmult_lt_0_compat; assumption |].
  apply Rle_trans with (e * y); [lra |].
  replace (sc * u * u * (e * v)) with (e * (sc * u * u * v)) by ring.
  apply Rmult_le_compat_l; lra.
Qed.

Theorem switches_sound : switches_fall = true -> decays_by_mode.
Proof.
  unfold switches_fall. rewrite andb_true_iff. intros [Pl Sw].
  assert (Each : forall a m, nth_error places a = Some m -> place_falls m = true).
  { intros a m E. apply (every_sound _ _ Pl). exact (nth_error_In _ _ E). }
  intros i j x time m l w span Ei Ej H T St.
  assert (Main : forall j y t, reaches i x t j y -> forall l, nth_error places j = Some l ->
    quad (form l) y <= exp (- (2 * alpha) * t) * quad (form m) x).
  { clear - Each Sw Ei. intros j y t H. induction H as [| time span s m' w z H IH I Es T D St Z];
      intros l Ej.
    - rewrite Ei in Ej. injection Ej as <-. rewrite Rmult_0_r, exp_0. lra.
    - specialize (IH m' Es). pose proof (stays_falls m' w span (Each _ _ Es) T St) as K.
      apply (every_sound _ _ Sw) in I. unfold switch_falls in I. rewrite Es, Ej in I.
      rewrite !andb_true_iff, Z.ltb_lt in I. destruct I as [[_ Dp] I].
      rewrite (quad_ext _ _ _ Z), exp_sum, Rmult_assoc.
      apply Rle_trans with (exp (- (2 * alpha) * span) * quad (form m') (w 0));
        [| apply Rmult_le_compat_l; [left; apply exp_pos | exact IH]].
      destruct (Z.eqb_spec (fst (dwell m')) 0) as [Zero | _].
      + pose proof (leads_sound _ _ _ _ _ (w span) I) as L.
        replace (1 / 1 * (1 / 1) * quad (form m') (w span)) with (quad (form m') (w span)) in L
          by field.
        apply Rle_trans with (1 := L), K.
      + set (d := IZR (fst (dwell m')) / IZR (snd (dwell m'))) in *.
        apply Rle_trans with (1 := bridged_sound m' l s w span (Each _ _ Es) Dp I St D). fold d.
        assert (d0 : 0 <= d).
        { unfold bridged in I. cbv zeta in I. rewrite !andb_true_iff, !Z.ltb_lt in I.
          left. apply Rdiv_lt_0_compat; apply (IZR_lt 0); tauto. }
        assert (Part : stays m' w (span - d)).
        { destruct St as [C M]. split; intros; [apply C | apply M]; auto; lra. }
        replace span with (span - d + d) at 2 by ring. rewrite exp_sum, Rmult_assoc.
        apply Rmult_le_compat_l; [left; apply exp_pos |].
        apply (stays_falls m' w (span - d) (Each _ _ Es)); [lra | exact Part]. }
  split.
  - apply Rle_trans with (1 := stays_falls l w span (Each _ _ Ej) T St).
    rewrite exp_sum, Rmult_assoc. apply Rmult_le_compat_l; [left; apply exp_pos |].
    exact (Main _ _ _ H _ Ej).
  - pose proof (Each _ _ Ej) as E. unfold place_falls in E. rewrite !andb_true_iff in E.
    destruct E as [[S X] _]. pose proof (exceeds_sound _ _ (w span) X) as K.
    replace (length (form l)) with (size l) in K; [exact K |].
    clear - S. revert S. generalize (form l). induction (size l) as [| n IH]; intros [| [c r] F] S;
      simpl in *; try discriminate; [reflexivity |].
    apply andb_true_iff in S. f_equal. apply IH, S.
Qed.
End Switches.
