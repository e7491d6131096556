(** ** Discrete time, with rules of switching: one form for each mode *)

(* A mode is in force for so many steps, at least and at most; a form may rise in one that must be
   left. *)
Record place := Place
  { motion : linear; form : sym; shortest : nat; longest : option nat; must_be_left : bool }.
(* From a mode to a mode, by their places in the list, and what becomes of the state. *)
Record switch := Switch { from : nat; to : nat; reset : option linear }.

Section Stays.
Variables (p q factor : Z) (places : list place) (switches : list switch).

Definition may_last (m : place) (count : nat) : Prop :=
  (shortest m <= count)%nat /\ match longest m with None => True | Some l => (count <= l)%nat end.

(* From the state x, where the mode i begins, the state y, where the mode j begins, is reached after
   so many steps: stays in modes, and a switch after each. *)
Inductive reaches (i : nat) (x : vec) : nat -> nat -> vec -> Prop :=
  | at_first : reaches i x 0 i x
  | after_stay steps count s m y z :
      reaches i x steps (from s) y -> In s switches -> nth_error places (from s) = Some m ->
      may_last m count -> (forall k, z k = moved (reset s) (repeated (motion m) count y) k) ->
      reaches i x (steps + count) (to s) z.

(* The form of the mode falls from switch to switch, and in modes that need not be left at every
   step between; each is no smaller than the squares of the states but for a factor. *)
Definition decays_by_mode (rho : R) : Prop :=
  0 <= rho < 1
  /\ forall i j x y steps m l,
  nth_error places i = Some m -> nth_error places j = Some l -> reaches i x steps j y ->
  quad (form l) y <= rho ^ (2 * steps) * quad (form m) x
  /\ (must_be_left l = false -> forall count,
      quad (form l) (repeated (motion l) count y) <= rho ^ (2 * (steps + count)) * quad (form m) x)
  /\ norm2 (length (form l)) y <= IZR factor * quad (form l) y.

Definition counts (m : place) : list nat :=
  if must_be_left m then
    match longest m with Some l => seq (shortest m) (S l - shortest m) | None => [] end
  else [shortest m].

Definition place_falls (m : place) : bool :=
  exceeds factor (form m)
  && (if must_be_left m then match longest m with Some _ => true | None => false end
      else leads p q (form m) (form m) (Some (motion m))).

Definition switch_falls (s : switch) : bool :=
  match nth_error places (from s), nth_error places (to s) with
  | Some m, Some l =>
      every (fun c => leads (p ^ Z.of_nat c) (q ^ Z.of_nat c) (form m) (form l)
                          (following (reset s) (power (motion m) c))) (counts m)
  | _, _ => false
  end.

Definition stays_fall : bool :=
  (0 <=? p)%Z && (p <? q)%Z && every place_falls places && every switch_falls switches.

Notation rho := (IZR p / IZR q).

Lemma rho_power c : IZR (p ^ Z.of_nat c) / IZR (q ^ Z.of_nat c) * (IZR (p ^ Z.of_nat c)
  / IZR (q ^ Z.of_nat c)) = rho ^ (2 * c).
Proof.
  replace (2 * c)%nat with (c + c)%nat by lia. rewrite pow_add.
  enough (E : IZR (p ^ Z.of_nat c) / IZR (q ^ Z.of_nat c) = rho ^ c) by (rewrite E; reflexivity).
  rewrite <- !pow_IZR. unfold Rdiv. rewrite Rpow_mult_distr. f_equal.
  destruct (Req_dec (IZR q) 0) as [E | N]; [| symmetry; apply pow_inv].
  rewrite E. destruct c; simpl; [apply Rinv_1 |]. rewrite Rmult_0_l, !Rinv_0. ring.
Qed.

Theorem stays_sound : stays_fall = true -> decays_by_mode rho.
Proof.
  unfold stays_fall. rewrite !andb_true_iff, Z.leb_le, Z.ltb_lt. intros [[[P0 Q] Pl] Sw].
  pose proof (IZR_le _ _ P0) as P1. pose proof (IZR_lt _ _ Q) as Q1.
  assert (R : 0 <= rho < 1).
  { split; [apply Rmult_le_pos; [lra |]; left; apply Rinv_0_lt_compat; lra |].
    apply Rmult_lt_reg_r with (IZR q); [lra |]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l; lra. }
  split; [exact R |].
  assert (Each : forall a m, nth_error places a = Some m -> place_falls m = true).
  { intros a m E. apply (every_sound _ _ Pl). exact (nth_error_In _ _ E). }
  assert (On : forall a m, nth_error places a = Some m -> must_be_left m = false ->
    forall c y, quad (form m) (repeated (motion m) c y) <= rho ^ (2 * c) * quad (form m) y).
  { intros a m E L c y. specialize (Each a m E). unfold place_falls in Each. rewrite L in Each.
    apply andb_true_iff in Each. destruct Each as [_ K]. induction c as [| c IH]; [simpl; lra |].
    replace (2 * S c)%nat with (2 + 2 * c)%nat by lia. rewrite pow_add, Rmult_assoc.
    pose proof (leads_sound _ _ _ _ _ (repeated (motion m) c y) K) as D. simpl moved in D.
    apply Rle_trans with (1 := D). replace (rho ^ 2) with (rho * rho) by ring.
    apply Rmult_le_compat_l; [nra | exact IH]. }
  assert (Nonneg : forall c, 0 <= rho ^ c) by (intro; apply pow_le; lra).
  intros i j x y steps m l Ei Ej H.
  assert (Main : quad (form l) y <= rho ^ (2 * steps) * quad (form m) x).
  { revert l Ej. induction H as [| steps count s m' y z H IH I Es C Z]; intros l Ej.
    - rewrite Ei in Ej. injection Ej as <-. simpl. lra.
    - specialize (IH m' Es).
      apply (every_sound _ _ Sw) in I. unfold switch_falls in I. rewrite Es, Ej in I.
      rewrite (quad_ext _ _ _ Z). destruct C as [C1 C2].
      assert (Last : forall c y', In c (counts m') ->
        quad (form l) (moved (reset s) (repeated (motion m') c y'))
        <= rho ^ (2 * c) * quad (form m') y').
      { intros c y' K. apply (every_sound _ _ I) in K.
        pose proof (leads_sound _ _ _ _ _ y' K) as D. rewrite rho_power in D.
        rewrite (quad_ext _ _ (moved (reset s) (repeated (motion m') c y'))) in D; [exact D |].
        intro k. rewrite moved_following. destruct (reset s); [| apply moved_power].
        apply applied_ext. intro; apply moved_power. }
      replace (2 * (steps + count))%nat with (2 * count + 2 * steps)%nat by lia.
      rewrite pow_add, Rmult_assoc.
      apply Rle_trans with (rho ^ (2 * count) * quad (form m') y);
        [| apply Rmult_le_compat_l; [apply Nonneg | exact IH]].
      destruct (must_be_left m') eqn:L.
      + apply Last. unfold counts. rewrite L. specialize (Each _ _ Es). unfold place_falls in Each.
        rewrite L in Each. destruct (longest m') as [b |].
        * apply in_seq. lia.
        * rewrite andb_false_r in Each. discriminate.
      + replace count with (shortest m' + (count - shortest m'))%nat by lia.
        rewrite repeated_add.
        apply Rle_trans with (1 := Last _ _ ltac:(unfold counts; rewrite L; left; reflexivity)).
        replace (2 * (shortest m' + (count - shortest m')))%nat
          with (2 * shortest m' + 2 * (count - shortest m'))%nat by lia.
        rewrite pow_add, Rmult_assoc. apply Rmult_le_compat_l; [apply Nonneg |].
        apply (On _ _ Es L). }
  split; [exact Main |]. split.
  - intros L count. apply Rle_trans with (1 := On _ _ Ej L count y).
    replace (2 * (steps + count))%nat with (2 * count + 2 * steps)%nat by lia.
    rewrite pow_add, Rmult_assoc. apply Rmult_le_compat_l; [apply Nonneg | exact Main].
  - apply exceeds_sound. specialize (Each _ _ Ej). unfold place_falls in Each.
    apply andb_true_iff in Each. apply Each.
Qed.
End Stays.
