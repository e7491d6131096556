(** ** Steps of a sampled loop *)

(* State and errors of the arithmetic are counted in units: with zeta_j the j-th of them over its
   unit, the next state is the sum of the zeta_j times the j-th column. The i-th error is no larger
   than the i-th of the bounds, a row over the zeta_j. *)
Record mode := Mode { units : list Z; columns : list (list Z); bounds : list (list Z) }.

Definition zeta (n : nat) (m : mode) (x e : vec) : vec :=
  fun k => joined n x e k / IZR (nth k (units m) 1%Z).
(* Bounds of the errors. *)
Definition bound (n : nat) (m : mode) (x e : vec) : vec :=
  fun i => dot (nth i (bounds m) []) (zeta n m x e).
Definition after (n : nat) (m : mode) (x e : vec) : vec := image (columns m) (zeta n m x e).

(* Next states and bounds of the modes, and any average of them. *)
Inductive average (n : nat) (modes : list mode) (x e : vec) : vec -> vec -> Prop :=
  | of_one m : In m modes -> average n modes x e (after n m x e) (bound n m x e)
  | of_two a v b u c : 0 <= a <= 1 -> average n modes x e v b -> average n modes x e u c ->
      average n modes x e (mix a v u) (mix a b c).

(* What is at most some number in every mode, but for what is known of the errors, is so in any
   average if it is convex. *)
Lemma average_below n modes x e ms top (f : vec -> R) v b :
  (forall a v u, 0 <= a <= 1 -> f (mix a v u) <= (1 - a) * f v + a * f u) ->
  forallb (Z.leb 0) ms = true ->
  (forall m, In m modes ->
     f (after n m x e) <= top + dot ms (fun i => squared e i - squared (bound n m x e) i)) ->
  average n modes x e v b -> f v <= top + dot ms (fun i => squared e i - squared b i).
Proof.
  intros C P One H. induction H as [m I | a v b u c A _ IHv _ IHu]; [exact (One m I) |].
  pose proof (C a v u A) as K. pose proof (limits_convex ms a A P e b c) as L. unfold mix at 2.
  assert ((1 - a) * f v <= (1 - a) * (top + dot ms (fun i => squared e i - squared b i)))
    by (apply Rmult_le_compat_l; lra).
  assert (a * f u <= a * (top + dot ms (fun i => squared e i - squared c i)))
    by (apply Rmult_le_compat_l; lra).
  lra.
Qed.

Lemma known_errors ms : forall e b, forallb (Z.leb 0) ms = true ->
  (forall i, (i < length ms)%nat -> Rabs (e i) <= Rabs (b i)) ->
  dot ms (fun i => squared e i - squared b i) <= 0.
Proof.
  induction ms as [| m ms IH]; intros e b P H; cbn [dot forallb length] in *; [lra |].
  apply andb_true_iff in P. destruct P as [M P]. apply Z.leb_le, (IZR_le 0) in M.
  pose proof (IH (tail e) (tail b) P (fun i I => H (S i) ltac:(lia))) as K.
  pose proof (H 0%nat ltac:(lia)) as H0. apply Rsqr_le_abs_1 in H0. unfold Rsqr in H0.
  unfold tail, squared in *. nra.
Qed.

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

Lemma dot_unit k : forall u x, dot (unit_row k u) x = IZR u * x k.
Proof.
  induction k as [| k IH]; intros u x; [simpl; lra |].
  change (IZR 0 * x 0%nat + dot (unit_row k u) (tail x) = IZR u * x (S k)).
  rewrite IH. unfold tail. lra.
Qed.

Lemma slack_quad us : forall k rows ms x, length us = length ms -> length rows = length ms ->
  quad (slack k us rows ms) x
  = dot ms (fun i => IZR (nth i us 1%Z) * x (k + i)%nat * (IZR (nth i us 1%Z) * x (k + i)%nat)
                     - dot (nth i rows []) x * dot (nth i rows []) x).
Proof.
  induction us as [| u us IH]; intros k [| row rows] [| m ms] x L K; simpl in L, K; try lia;
    [reflexivity |].
  cbn [slack dot]. rewrite !quad_lin, !quad_square, dot_unit, opp_IZR, (IH (S k) rows ms x) by lia.
  rewrite Nat.add_0_r. cbn [nth].
  rewrite (dot_ext ms (tail _) (fun i => IZR (nth i us 1%Z) * x (S k + i)%nat
      * (IZR (nth i us 1%Z) * x (S k + i)%nat) - dot (nth i rows []) x * dot (nth i rows []) x)).
  - simpl. ring.
  - intro i. unfold tail. cbn [nth]. rewrite Nat.add_succ_r. reflexivity.
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

Lemma nth_skipn n : forall us i, nth i (skipn n us) 1%Z = nth (n + i) us 1%Z.
Proof.
  induction n as [| n IH]; intros [| u us] i; simpl; try reflexivity; [destruct i; reflexivity |].
  apply IH.
Qed.

Lemma length_first n : forall us : list Z, (n <= length us)%nat -> length (firstn n us) = n.
Proof. induction n as [| n IH]; intros [| u us] H; simpl in *; try lia. rewrite IH; lia. Qed.

Lemma length_rest n : forall us : list Z, length (skipn n us) = (length us - n)%nat.
Proof. induction n as [| n IH]; intros [| u us]; simpl; auto; lia. Qed.

Hypothesis q_positive : (0 < q)%Z.

(* What is left of F over G after the step, with what is known of the errors. *)
Lemma decrease_quad n m ms F G cols x e :
  fits n m ms = true -> shaped n F = true ->
  quad (decrease n m ms F G cols) (zeta n m x e)
  = (IZR p / IZR q) * (IZR p / IZR q) * quad F x - quad G (image cols (zeta n m x e))
    + dot ms (fun i => squared e i - squared (bound n m x e) i).
Proof.
  intros Fit S. unfold fits in Fit. rewrite !andb_true_iff in Fit.
  destruct Fit as [[[[U L] D] Lm] _]. apply Nat.eqb_eq in L, Lm.
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
      - apply nth_In. rewrite length_first; lia.
      - rewrite length_first; lia. }
    apply (f_equal IZR) in C. rewrite !mult_IZR in C.
    specialize (P k ltac:(lia)). set (u := IZR (nth k (units m) 1%Z)) in *.
    apply Rmult_eq_reg_l with (IZR q); [| lra].
    replace (IZR q * (IZR p / IZR q * x k)) with (IZR p * u * (x k / u)) by (field; lra).
    rewrite <- C. ring. }
  rewrite E. clear E.
  rewrite slack_quad by (rewrite ?length_rest; lia).
  rewrite (dot_ext_below ms _ (fun i => squared e i - squared (bound n m x e) i)); [ring |].
  intros i I. rewrite nth_skipn. unfold squared, bound.
  replace (IZR (nth (n + i) (units m) 1%Z) * zeta n m x e (n + i)%nat) with (e i); [reflexivity |].
  specialize (P (n + i)%nat ltac:(lia)). unfold zeta, joined.
  rewrite (proj2 (Nat.ltb_ge (n + i) n)) by lia. replace (n + i - n)%nat with i by lia.
  field. lra.
Qed.

Definition falls n m ms F G cols : bool :=
  fits n m ms && shaped n F && positive (decrease n m ms F G cols).

(* The same where the first state is positive before the step and not positive after it. *)
Definition falls_lost n m lost ms F G cols : bool :=
  fits n m ms && shaped n F && (0 <=? lost)%Z && (0 <? n)%nat
  && positive (slin 1 (decrease n m ms F G (map (@tl Z) cols)) 1
                 (crossing lost (nth 0 (units m) 1%Z) (map (hd 0%Z) cols))).

Lemma falls_sound n m ms F G cols x e : falls n m ms F G cols = true ->
  quad G (image cols (zeta n m x e)) <= (IZR p / IZR q) * (IZR p / IZR q) * quad F x
    + dot ms (fun i => squared e i - squared (bound n m x e) i).
Proof.
  unfold falls. rewrite !andb_true_iff. intros [[Fit S] P].
  pose proof (decrease_quad _ _ _ _ G cols x e Fit S).
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
  falls_lost n m lost ms F G cols = true ->
  quad G (tail (image cols (zeta n m x e)))
    - 2 * IZR lost * x 0%nat * image cols (zeta n m x e) 0%nat
  <= (IZR p / IZR q) * (IZR p / IZR q) * quad F x
    + dot ms (fun i => squared e i - squared (bound n m x e) i).
Proof.
  unfold falls_lost. rewrite !andb_true_iff. intros [[[[Fit S] L] N] P].
  pose proof (decrease_quad _ _ _ _ G (map (@tl Z) cols) x e Fit S) as D.
  pose proof (positive_sound _ P (zeta n m x e)) as Q.
  rewrite quad_lin, quad_crossing, <- image_head in Q.
  rewrite (quad_ext G _ (tail (image cols (zeta n m x e)))) in D by (intro; apply image_tail).
  apply Nat.ltb_lt in N.
  unfold fits in Fit. rewrite !andb_true_iff in Fit. destruct Fit as [[[[U Le] _] _] _].
  apply Nat.eqb_eq in Le.
  assert (E : IZR (nth 0 (units m) 1%Z) * zeta n m x e 0%nat = x 0%nat).
  { unfold zeta, joined. rewrite (proj2 (Nat.ltb_lt 0 n) N). field.
    apply Rgt_not_eq, (IZR_lt 0), Z.ltb_lt, (proj1 (forallb_forall _ _) U), nth_In. lia. }
  rewrite E in Q. lra.
Qed.
End Edge.
