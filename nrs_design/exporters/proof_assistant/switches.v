(** ** Continuous time, with rules of switching: one form for each mode *)

Record place := Place { size : nat; law : flow; form : sym; dwell : Z * Z; gives : witness }.
(* From a mode to a mode, by their places in the list, and what becomes of the state. *)
Record switch := Switch { from : nat; to : nat; reset : option linear }.

Section Switches.
Variables (p q factor : Z) (places : list place) (switches : list switch).
Notation alpha := (IZR p / IZR q).

(* The mode m is in force from zero to a time. *)
Definition stays (m : place) (w : R -> vec) (time : R) : Prop :=
  (forall k t, (k < size m)%nat -> 0 < t <= time -> continuity_pt (fun s => w s k) t)
  /\ (forall t, 0 <= t < time -> moves (size m) false [law m] [] w none none t).

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

Definition switch_falls (s : switch) : bool :=
  match nth_error places (from s), nth_error places (to s) with
  | Some m, Some l =>
      (0 <=? fst (dwell m))%Z && (0 <? snd (dwell m))%Z
      && leads 1 1 (form m) (form l) (reset s)
  | _, _ => false
  end.

Definition switches_fall : bool := forallb place_falls places && forallb switch_falls switches.

Lemma stays_falls m w span : place_falls m = true -> 0 <= span -> stays m w span ->
  quad (form m) (w span) <= exp (- (2 * alpha) * span) * quad (form m) (w 0).
Proof.
  unfold place_falls. rewrite !andb_true_iff. intros [[S _] F] T [C M].
  pose proof (decays_sound _ _ _ _ _ _ _ _ _ _ _ _ _ _ _ F eq_refl w span T C M) as D.
  unfold seen in D. rewrite !V_singles in D by exact S.
  replace (2 * alpha) with (2 * INR 1 * alpha) by (simpl; ring). exact D.
Qed.

Theorem switches_sound : switches_fall = true -> decays_by_mode.
Proof.
  unfold switches_fall. rewrite andb_true_iff. intros [Pl Sw].
  assert (Each : forall a m, nth_error places a = Some m -> place_falls m = true).
  { intros a m E. apply (proj1 (forallb_forall _ _) Pl). exact (nth_error_In _ _ E). }
  intros i j x time m l w span Ei Ej H T St.
  assert (Main : forall j y t, reaches i x t j y -> forall l, nth_error places j = Some l ->
    quad (form l) y <= exp (- (2 * alpha) * t) * quad (form m) x).
  { clear - Each Sw Ei. intros j y t H. induction H as [| time span s m' w z H IH I Es T D St Z];
      intros l Ej.
    - rewrite Ei in Ej. injection Ej as <-. rewrite Rmult_0_r, exp_0. lra.
    - specialize (IH m' Es). pose proof (stays_falls m' w span (Each _ _ Es) T St) as K.
      apply (proj1 (forallb_forall _ _) Sw) in I. unfold switch_falls in I. rewrite Es, Ej in I.
      rewrite !andb_true_iff in I. destruct I as [_ I].
      pose proof (leads_sound _ _ _ _ _ (w span) I) as L. rewrite (quad_ext _ _ _ Z).
      replace (1 / 1 * (1 / 1) * quad (form m') (w span)) with (quad (form m') (w span)) in L by field.
      apply Rle_trans with (1 := L), Rle_trans with (1 := K).
      replace (- (2 * alpha) * (time + span)) with (- (2 * alpha) * span + - (2 * alpha) * time) by ring.
      rewrite exp_plus, Rmult_assoc. apply Rmult_le_compat_l; [left; apply exp_pos | exact IH]. }
  split.
  - apply Rle_trans with (1 := stays_falls l w span (Each _ _ Ej) T St).
    replace (- (2 * alpha) * (time + span)) with (- (2 * alpha) * span + - (2 * alpha) * time) by ring.
    rewrite exp_plus, Rmult_assoc. apply Rmult_le_compat_l; [left; apply exp_pos |].
    exact (Main _ _ _ H _ Ej).
  - pose proof (Each _ _ Ej) as E. unfold place_falls in E. rewrite !andb_true_iff in E.
    destruct E as [[S X] _]. pose proof (exceeds_sound _ _ (w span) X) as K.
    replace (length (form l)) with (size l) in K; [exact K |].
    clear - S. revert S. generalize (form l). induction (size l) as [| n IH]; intros [| [c r] F] S;
      simpl in *; try discriminate; [reflexivity |].
    apply andb_true_iff in S. f_equal. apply IH, S.
Qed.
End Switches.
