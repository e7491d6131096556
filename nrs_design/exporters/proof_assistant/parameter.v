(** ** Continuous time, with a parameter that is unknown but constant *)

Section Constant.
Variables (n : nat) (p q factor : Z) (low high : sym) (pairs : list (flow * flow)).
Notation rate := (IZR p / IZR q).

(* The form at the parameter l, from zero to one. *)
Definition between (l : R) (x : vec) : R := (1 - l) * quad low x + l * quad high x.

(* At the time t, the mode between the two of a pair is in force; which pair may change at every
   time. *)
Definition moves_between (l : R) (x : R -> vec) (t : R) : Prop :=
  exists f g, In (f, g) pairs /\ forall k, (k < n)%nat ->
  right (fun s => x s k)
    ((1 - l) * field f (joined n (x t) none) k + l * field g (joined n (x t) none) k) t.

Definition decays_between : Prop :=
  forall (l : R) (x : R -> vec) (time : R), 0 <= l <= 1 -> 0 <= time ->
  (forall k t, (k < n)%nat -> 0 < t <= time -> continuity_pt (fun s => x s k) t) ->
  (forall t, 0 <= t < time -> moves_between l x t) ->
  between l (x time) <= exp (- (2 * rate) * time) * between l (x 0)
  /\ norm2 n (x time) <= IZR factor * between l (x time).

Let basis := singles n.
Let low_p : poly := collected (expanded low basis).
Let high_p : poly := collected (expanded high basis).

Definition is_mixed_falling (f g : flow) (w : witness) : bool :=
  let c := times_decrease w in
  let P := pscale (c * q * over g) (along (rows f) high_p)
           ++ pscale (c * q * over f) (along (rows g) low_p)
           ++ pscale (2 * p * c * over f * over g) (high_p ++ low_p)
           ++ pscale (q * over f * over g) (expanded (gram w) basis) in
  (0 <? c)%Z && (0 <? over f)%Z && (0 <? over g)%Z && vanishes P && positive (gram w).

Fixpoint pairs_fall (ps : list (flow * flow)) (ws : list (witness * witness * witness)) : bool :=
  match ps, ws with
  | [], [] => true
  | (f, g) :: ps', (a, b, m) :: ws' =>
      is_falling n 1 p q basis low [] false f a basis
      && is_falling n 1 p q basis high [] false g b basis
      && is_mixed_falling f g m && pairs_fall ps' ws'
  | _, _ => false
  end.

Definition parameter_falls (ws : list (witness * witness * witness)) : bool :=
  (0 <? q)%Z && shaped n low && shaped n high && within n low_p && within n high_p
  && positive (lowered n (map (zrow factor) low)) && positive (lowered n (map (zrow factor) high))
  && pairs_fall pairs ws.

Lemma mixed_falling f g w z : (0 < q)%Z -> is_mixed_falling f g w = true ->
  slope high_p z (field f z) + slope low_p z (field g z)
  <= - (2 * rate) * (peval high_p z + peval low_p z).
Proof.
  intros Q. unfold is_mixed_falling. cbv zeta. rewrite !andb_true_iff, !Z.ltb_lt.
  intros [[[[C O] U] E] G]. pose proof (positive_sound _ G (monomials basis z)) as T.
  apply (vanishes_sound _ z) in E.
  rewrite !peval_app, !peval_scale, !peval_app, peval_expanded, !peval_along in E.
  unfold field. rewrite !slope_times. rewrite !mult_IZR in E.
  set (s := slope high_p z _) in *. set (r := slope low_p z _) in *.
  set (h := peval high_p z) in *. set (v := peval low_p z) in *. set (t := quad (gram w) _) in *.
  apply (IZR_lt 0) in C, O, U, Q.
  set (c := IZR (times_decrease w)) in *. set (o := IZR (over f)) in *. set (u := IZR (over g)) in
    *.
  apply Rmult_le_reg_l with (c * IZR q * o * u); [repeat apply Rmult_lt_0_compat; assumption |].
  replace (c * IZR q * o * u * (/ o * s + / u * r)) with (c * IZR q * u * s + c * IZR q * o * r)
    by (field; lra).
  replace (c * IZR q * o * u * (- (2 * (IZR p / IZR q)) * (h + v)))
    with (- (2 * IZR p * c * o * u * (h + v))) by (field; lra).
  assert (0 <= IZR q * o * u * t) by (repeat apply Rmult_le_pos; lra).
  lra.
Qed.

Theorem parameter_sound ws : parameter_falls ws = true -> decays_between.
Proof.
  unfold parameter_falls. rewrite !andb_true_iff, Z.ltb_lt.
  intros [[[[[[[Q Sl] Sh] Wl] Wh] Pl] Ph] Pairs] l x time L T C M.
  set (y := fun s => joined n (x s) none).
  assert (Y : forall F, shaped n F = true -> forall s, peval (collected (expanded F basis)) (y s)
                        = quad F (x s)).
  { intros F S s. rewrite peval_collected, peval_expanded.
    change (V basis F (y s) = quad F (x s)). unfold basis. rewrite V_singles by exact S.
    apply (quad_ext_below n); [exact S |]. intros k K. unfold y, joined.
    rewrite (proj2 (Nat.ltb_lt k n) K). reflexivity. }
  assert (In_n : forall P, within n P = true -> forall c m, In (c, m) P -> forall i, In i m ->
                 (i < n)%nat).
  { intros P W c m I i J. apply (proj1 (forallb_forall _ _) W) in I. simpl in I.
    apply (proj1 (forallb_forall _ _) I) in J. apply Nat.ltb_lt, J. }
  assert (At : forall s k, (k < n)%nat -> x s k = y s k).
  { intros s k K. unfold y, joined. rewrite (proj2 (Nat.ltb_lt k n) K). reflexivity. }
  split.
  - set (U := fun s => (1 - l) * peval low_p (y s) + l * peval high_p (y s)).
    assert (E : forall s, between l (x s) = U s).
    { intro s. unfold between, U, low_p, high_p. rewrite (Y low Sl), (Y high Sh). reflexivity. }
    rewrite !E. apply (falls_exponentially U (2 * rate) time T).
    + intros s S. destruct (M s S) as (f & g & I & D).
      set (v := fun k => (1 - l) * field f (y s) k + l * field g (y s) k).
      assert (Dy : forall k, (k < n)%nat -> right (fun r => y r k) (v k) s).
      { intros k K. apply (right_ext (fun r => x r k) _ _ _ 1 Rlt_0_1); [| exact (D k K)].
        intros. apply At, K. }
      exists ((1 - l) * slope low_p (y s) v + l * slope high_p (y s) v). split.
      * assert (One : forall P a, within n P = true ->
          right (fun r => a * peval P (y r)) (a * slope P (y s) v) s).
        { intros P a W. replace (a * slope P (y s) v) with (0 * peval P (y s) + a * slope P (y s) v)
            by ring.
          apply (right_times (fun _ => a) (fun r => peval P (y r))); [apply right_const |].
          apply right_peval. intros c m J i Im. apply Dy, (In_n P W c m J i Im). }
        apply (right_add (fun r => (1 - l) * peval low_p (y r)) (fun r => l * peval high_p (y r)));
          apply One; assumption.
      * unfold v. rewrite !slope_mix. unfold U.
        assert (K : slope low_p (y s) (field f (y s)) <= - (2 * rate) * peval low_p (y s)
          /\ slope high_p (y s) (field g (y s)) <= - (2 * rate) * peval high_p (y s)
          /\ slope high_p (y s) (field f (y s)) + slope low_p (y s) (field g (y s))
             <= - (2 * rate) * (peval high_p (y s) + peval low_p (y s))).
        { clear - Pairs I Q Y. revert ws Pairs I. induction pairs as [| [f' g'] ps IH];
            intros [| [[a b] m] ws] H I; simpl in *; try tauto; try discriminate.
          rewrite !andb_true_iff in H. destruct H as [[[A B] X] H].
          destruct I as [E | I]; [injection E as -> -> | exact (IH ws H I)].
          pose proof (falling n 1 p q basis low [] false f a basis (x s) none Q A
            ltac:(discriminate))
            as Ka.
          pose proof (falling n 1 p q basis high [] false g b basis (x s) none Q B
            ltac:(discriminate))
            as Kb.
          pose proof (mixed_falling f g m (y s) Q X) as Kc. cbv zeta in Ka, Kb.
          rewrite V_polynomial in Ka, Kb. simpl dot in Ka, Kb.
          unfold alpha in Ka, Kb. replace (2 * INR 1 * (IZR p / IZR q)) with (2 * (IZR p / IZR q))
            in Ka, Kb by (simpl; ring).
          fold low_p in Ka. fold high_p in Kb. fold (y s) in Ka, Kb.
          repeat split; lra. }
        destruct K as (Ka & Kb & Kc).
        set (a := slope low_p (y s) (field f (y s))) in *.
        set (b := slope high_p (y s) (field g (y s))) in *.
        set (c := slope low_p (y s) (field g (y s))) in *.
        set (d := slope high_p (y s) (field f (y s))) in *.
        set (e := peval low_p (y s)) in *. set (h := peval high_p (y s)) in *.
        set (r := - (2 * rate)) in *.
        assert ((1 - l) * (1 - l) * a <= (1 - l) * (1 - l) * (r * e))
          by (apply Rmult_le_compat_l; [nra | exact Ka]).
        assert (l * l * b <= l * l * (r * h)) by (apply Rmult_le_compat_l; [nra | exact Kb]).
        assert ((1 - l) * l * (d + c) <= (1 - l) * l * (r * (h + e)))
          by (apply Rmult_le_compat_l; [nra | exact Kc]).
        replace (r * ((1 - l) * e + l * h))
          with ((1 - l) * (1 - l) * (r * e) + l * l * (r * h) + (1 - l) * l * (r * (h + e))) by
            ring.
        lra.
    + intros s S.
      assert (Cy : forall k, (k < n)%nat -> continuity_pt (fun r => y r k) s).
      { intros k K. apply (continuous_ext (fun r => x r k)); [intro; apply At, K | apply C; auto]. }
      assert (One : forall P a, within n P = true -> continuity_pt (fun r => a * peval P (y r)) s).
      { intros P a W. apply (continuity_pt_mult (fun _ => a) (fun r => peval P (y r)));
          [apply continuity_pt_const; intros ? ?; reflexivity |].
        apply continuous_peval. intros c m J i Im. apply Cy, (In_n P W c m J i Im). }
      apply (continuity_pt_plus (fun r => (1 - l) * peval low_p (y r))
               (fun r => l * peval high_p (y r))); apply One; assumption.
  - pose proof (positive_sound _ Pl (x time)) as A. pose proof (positive_sound _ Ph (x time)) as B.
    rewrite quad_lowered, quad_scale in A, B. unfold between. nra.
Qed.
End Constant.
