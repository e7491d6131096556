(** ** Steps of a sampled loop *)

(* State and errors of the arithmetic are counted in units: with zeta_j the j-th of them over its
   unit, the next state is the sum of the zeta_j times the j-th column. The i-th error is no larger
   than the i-th of the bounds, a row over the zeta_j. *)
Record mode := Mode { units : list Z; columns : list (list Z); bounds : list (list Z) }.

Definition zeta (n : nat) (m : mode) (x e : vec) : vec :=
  fun k => joined n x e k / IZR (nth k (units m) 1%Z).
Definition allowed (n : nat) (m : mode) (x e : vec) : Prop :=
  forall i, (i < length (bounds m))%nat ->
  Rabs (e i) <= Rabs (dot (nth i (bounds m) []) (zeta n m x e)).
Definition after (n : nat) (m : mode) (x e : vec) : vec := image (columns m) (zeta n m x e).

(* The largest of some forms. *)
Definition largest (forms : list sym) (x : vec) : R :=
  fold_right (fun F v => Rmax (quad F x) v) 0 forms.

(** What is checked of one step, from a form F to a form G, with rho = p / q. *)

Section Edge.
Variables p q : Z.

Definition unit_row (k : nat) (u : Z) : list Z := repeat 0%Z k ++ [u].

(* The sum of m_i (e_i^2 - (bound_i)^2) for multipliers m_i. *)
Fixpoint slack (k : nat) (us : list Z) (rows : list (list Z)) (ms : list Z) : sym :=
  match us, rows, ms with
  | u :: us', row :: rows', m :: ms' =>
      slin 1 (slin m (square (unit_row k u)) (- m) (square row)) 1 (slack (S k) us' rows' ms')
  | _, _, _ => []
  end.

(* 2 m delta (c zeta), with delta the first entry of the state. *)
Definition crossing (m u : Z) (c : list Z) : sym :=
  match c with [] => [] | c0 :: c' => [((2 * m * u * c0)%Z, map (Z.mul (m * u)) c')] end.

Definition fits (n : nat) (m : mode) (ms : list Z) : bool :=
  forallb (Z.ltb 0) (units m) && (n + length (bounds m) =? length (units m))%nat
  && forallb (fun u => (q * (u * p / q) =? p * u)%Z) (firstn n (units m))
  && (length ms =? length (bounds m))%nat && forallb (Z.leb 0) ms.

Definition decrease (n : nat) (m : mode) (ms : list Z) (F G : sym) (cols : list (list Z)) : sym :=
  slin 1 (scaled (map (fun u => u * p / q)%Z (firstn n (units m))) F) 1
    (slin (-1) (congruence G cols) 1 (slack n (skipn n (units m)) (bounds m) ms)).

Lemma dot_times_real r : forall t x, dot r (fun k => t * x k) = t * dot r x.
Proof.
  intros t x. rewrite <- (Rplus_0_r (t * dot r x)), <- (dot_zero r (fun _ => 0)) by reflexivity.
  rewrite <- dot_add. apply dot_ext. intro; lra.
Qed.

Lemma quad_times T : forall t x, quad T (fun k => t * x k) = t * t * quad T x.
Proof.
  induction T as [| [c r] T IH]; intros t x; simpl; [lra |].
  change (tail (fun k => t * x k)) with (fun k => t * tail x k).
  rewrite IH, dot_times_real. ring.
Qed.

Lemma dot_unit k : forall u x, dot (unit_row k u) x = IZR u * x k.
Proof.
  induction k as [| k IH]; intros u x; [simpl; lra |].
  change (IZR 0 * x 0%nat + dot (unit_row k u) (tail x) = IZR u * x (S k)).
  rewrite IH. unfold tail. lra.
Qed.

Lemma slack_below us : forall k rows ms x,
  (forall i, (i < length rows)%nat ->
     Rabs (IZR (nth i us 0%Z) * x (k + i)%nat) <= Rabs (dot (nth i rows []) x)) ->
  forallb (Z.leb 0) ms = true -> quad (slack k us rows ms) x <= 0.
Proof.
  induction us as [| u us IH]; intros k [| row rows] [| m ms] x H P; simpl in *; try lra.
  apply andb_true_iff in P. destruct P as [P0 P]. apply Z.leb_le, (IZR_le 0) in P0.
  rewrite !quad_lin, !quad_square, dot_unit, opp_IZR.
  pose proof (H 0%nat ltac:(lia)) as H0. simpl in H0. rewrite Nat.add_0_r in H0.
  apply Rsqr_le_abs_1 in H0. unfold Rsqr in H0.
  assert (quad (slack (S k) us rows ms) x <= 0).
  { apply IH; [| assumption]. intros i I. specialize (H (S i) ltac:(lia)).
    rewrite Nat.add_succ_r in H. exact H. }
  nra.
Qed.

Lemma quad_crossing m u c x : quad (crossing m u c) x = 2 * IZR m * (IZR u * x 0%nat) * dot c x.
Proof.
  destruct c as [| c0 c]; cbn [crossing quad dot]; [lra |].
  rewrite dot_scale, !mult_IZR. ring.
Qed.

Lemma nth_firstn_map (f : Z -> Z) n : forall us k, (k < n)%nat -> (k < length us)%nat ->
  nth k (map f (firstn n us)) 0%Z = f (nth k us 1%Z).
Proof.
  induction n as [| n IH]; intros [| u us] [| k] H L; simpl in *; try lia.
  apply IH; lia.
Qed.

Lemma nth_skipn n : forall us i, nth i (skipn n us) 0%Z = nth (n + i) us 0%Z.
Proof.
  induction n as [| n IH]; intros [| u us] i; simpl; try reflexivity; [destruct i; reflexivity |].
  apply IH.
Qed.

Hypothesis q_positive : (0 < q)%Z.

(* What is left of F over G after the step, but for what is known of the errors. *)
Lemma decrease_quad n m ms F G cols x e :
  fits n m ms = true -> shaped n F = true -> allowed n m x e ->
  quad (decrease n m ms F G cols) (zeta n m x e)
  <= (IZR p / IZR q) * (IZR p / IZR q) * quad F x - quad G (image cols (zeta n m x e)).
Proof.
  intros Fit S A. unfold fits in Fit. rewrite !andb_true_iff in Fit.
  destruct Fit as [[[[U L] D] _] M]. apply Nat.eqb_eq in L.
  pose proof (IZR_lt 0 q q_positive) as Q.
  unfold decrease. rewrite !quad_lin, quad_congruence, quad_scaled.
  assert (P : forall k, (k < length (units m))%nat -> 0 < IZR (nth k (units m) 1%Z)).
  { intros k K. apply (IZR_lt 0), Z.ltb_lt. apply (proj1 (forallb_forall _ _) U).
    apply nth_In. exact K. }
  assert (E : quad F (fun k => IZR (nth k (map (fun u => u * p / q)%Z (firstn n (units m))) 0%Z)
                        * zeta n m x e k)
            = IZR p / IZR q * (IZR p / IZR q) * quad F x).
  { rewrite <- quad_times. apply (quad_ext_below n); [exact S |]. intros k K.
    rewrite nth_firstn_map by lia. unfold zeta, joined.
    rewrite (proj2 (Nat.ltb_lt k n) K).
    assert (C : (q * (nth k (units m) 1 * p / q) = p * nth k (units m) 1)%Z).
    { apply Z.eqb_eq. apply (proj1 (forallb_forall _ _) D).
      rewrite <- (firstn_skipn n (units m)) at 1. rewrite app_nth1.
      - apply nth_In. rewrite firstn_length. lia.
      - rewrite firstn_length. lia. }
    apply (f_equal IZR) in C. rewrite !mult_IZR in C.
    specialize (P k ltac:(lia)). set (u := IZR (nth k (units m) 1%Z)) in *.
    apply Rmult_eq_reg_l with (IZR q); [| lra].
    replace (IZR q * (IZR p / IZR q * x k)) with (IZR p * u * (x k / u)) by (field; lra).
    rewrite <- C. ring. }
  rewrite E. clear E.
  assert (K : quad (slack n (skipn n (units m)) (bounds m) ms) (zeta n m x e) <= 0).
  { apply slack_below; [| exact M]. intros i I. rewrite nth_skipn.
    specialize (A i I). specialize (P (n + i)%nat ltac:(lia)).
    rewrite (nth_indep _ 0%Z 1%Z) by lia.
    replace (IZR (nth (n + i) (units m) 1%Z) * zeta n m x e (n + i)%nat) with (e i); [exact A |].
    unfold zeta, joined. rewrite (proj2 (Nat.ltb_ge (n + i) n)) by lia.
    replace (n + i - n)%nat with i by lia. field. lra. }
  lra.
Qed.

Definition falls n m ms F G cols : bool :=
  fits n m ms && shaped n F && positive (decrease n m ms F G cols).

(* The same where the first state is positive before the step and not positive after it. *)
Definition falls_lost n m lost ms F G cols : bool :=
  fits n m ms && shaped n F && (0 <=? lost)%Z && (0 <? n)%nat
  && positive (slin 1 (decrease n m ms F G (map (@tl Z) cols)) 1
                 (crossing lost (nth 0 (units m) 1%Z) (map (hd 0%Z) cols))).

Lemma falls_sound n m ms F G cols x e :
  falls n m ms F G cols = true -> allowed n m x e ->
  quad G (image cols (zeta n m x e)) <= (IZR p / IZR q) * (IZR p / IZR q) * quad F x.
Proof.
  unfold falls. rewrite !andb_true_iff. intros [[Fit S] P] A.
  pose proof (decrease_quad _ _ _ _ G cols _ _ Fit S A).
  pose proof (positive_sound _ P (zeta n m x e)). lra.
Qed.

Lemma image_head cols : forall x, image cols x 0%nat = dot (map (hd 0%Z) cols) x.
Proof.
  induction cols as [| c cols IH]; intro x; simpl; [reflexivity |].
  rewrite IH. destruct c; simpl; ring.
Qed.

Lemma image_tail cols : forall x k, image (map (@tl Z) cols) x k = image cols x (S k).
Proof.
  induction cols as [| c cols IH]; intros x k; simpl; [reflexivity |].
  rewrite IH. destruct c; simpl; [destruct k |]; reflexivity.
Qed.

Lemma falls_lost_sound n m lost ms F G cols x e :
  falls_lost n m lost ms F G cols = true -> allowed n m x e ->
  0 <= x 0%nat -> image cols (zeta n m x e) 0%nat <= 0 ->
  quad G (tail (image cols (zeta n m x e))) <= (IZR p / IZR q) * (IZR p / IZR q) * quad F x.
Proof.
  unfold falls_lost. rewrite !andb_true_iff. intros [[[[Fit S] L] N] P] A B C.
  pose proof (decrease_quad _ _ _ _ G (map (@tl Z) cols) _ _ Fit S A) as D.
  pose proof (positive_sound _ P (zeta n m x e)) as Q.
  rewrite quad_lin, quad_crossing, <- image_head in Q.
  rewrite (quad_ext G _ (tail (image cols (zeta n m x e)))) in D by (intro; apply image_tail).
  apply Z.leb_le, (IZR_le 0) in L. apply Nat.ltb_lt in N.
  unfold fits in Fit. rewrite !andb_true_iff in Fit. destruct Fit as [[[[U Le] _] _] _].
  apply Nat.eqb_eq in Le.
  assert (E : IZR (nth 0 (units m) 1%Z) * zeta n m x e 0%nat = x 0%nat).
  { unfold zeta, joined. rewrite (proj2 (Nat.ltb_lt 0 n) N). field.
    apply Rgt_not_eq, (IZR_lt 0), Z.ltb_lt, (proj1 (forallb_forall _ _) U), nth_In. lia. }
  rewrite E in Q.
  assert (0 <= - (IZR lost * x 0%nat * image cols (zeta n m x e) 0%nat)).
  { rewrite Ropp_mult_distr_r. apply Rmult_le_pos; [apply Rmult_le_pos |]; lra. }
  lra.
Qed.
End Edge.
