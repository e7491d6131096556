(** ** Forms that may be zero somewhere, decided by elimination in integers of any length *)

Fixpoint eliminated_exactly (fuel : nat) (T : sym) : bool :=
  match fuel, T with
  | _, [] => true
  | S fuel', (p, r) :: T' =>
      if (0 <? p)%Z then eliminated_exactly fuel' (slin p T' (-1) (square r))
      else if (p =? 0)%Z && forallb (Z.eqb 0) r then eliminated_exactly fuel' T' else false
  | O, _ => false
  end.

Definition nonnegative (T : sym) : bool := eliminated_exactly (length T) T.

Lemma zero_row r : forall x, forallb (Z.eqb 0) r = true -> dot r x = 0.
Proof.
  induction r as [| c r IH]; intros x H; [reflexivity |]. cbn [forallb dot] in *.
  apply andb_true_iff in H. destruct H as [C H]. apply Z.eqb_eq in C. rewrite <- C, IH; auto. ring.
Qed.

Lemma eliminated_exactly_sound fuel : forall T, eliminated_exactly fuel T = true ->
  forall x, 0 <= quad T x.
Proof.
  induction fuel as [| fuel IH]; intros [| [p r] T] H x; cbn [eliminated_exactly quad] in *;
    try lra; try discriminate.
  destruct (Z.ltb_spec 0 p) as [P |].
  - apply (IZR_lt 0) in P. pose proof (IH _ H (tail x)) as Q. rewrite quad_lin, quad_square in Q.
    set (s := dot r (tail x)) in *. set (q := quad T (tail x)) in *. set (a := x 0%nat).
    apply Rmult_le_reg_l with (IZR p); [assumption |]. rewrite Rmult_0_r.
    replace (IZR p * (IZR p * a * a + 2 * a * s + q))
      with ((IZR p * a + s) * (IZR p * a + s) + (IZR p * q + -1 * (s * s))) by ring.
    pose proof (Rle_0_sqr (IZR p * a + s)) as R0. unfold Rsqr in R0. lra.
  - destruct ((p =? 0)%Z && forallb (Z.eqb 0) r) eqn:E; [| discriminate].
    apply andb_true_iff in E. destruct E as [E R0]. apply Z.eqb_eq in E. subst p.
    rewrite (zero_row r (tail x) R0). pose proof (IH _ H (tail x)). lra.
Qed.

Theorem nonnegative_sound T : nonnegative T = true -> forall x, 0 <= quad T x.
Proof. apply eliminated_exactly_sound. Qed.

(** ** Products of matrices of columns *)

(* M c *)
Fixpoint zimage (columns : list (list Z)) (c : list Z) : list Z :=
  match columns, c with
  | col :: rest, x :: c' => zlin x col 1 (zimage rest c')
  | _, _ => []
  end.

Definition compose (left right : list (list Z)) : list (list Z) := map (zimage left) right.

Lemma nth_scale q b : forall k, IZR (nth k (map (Z.mul q) b) 0%Z) = IZR q * IZR (nth k b 0%Z).
Proof.
  induction b as [| x b IH]; intros [| k]; simpl; rewrite ?mult_IZR; try lra; apply IH.
Qed.

Lemma nth_lin p q a : forall b k,
  IZR (nth k (zlin p a q b) 0%Z) = IZR p * IZR (nth k a 0%Z) + IZR q * IZR (nth k b 0%Z).
Proof.
  induction a as [| x a IH]; intros b k.
  - cbn [zlin]. rewrite nth_scale. destruct k; simpl; lra.
  - destruct b as [| y b].
    + cbn [zlin]. rewrite nth_scale. destruct k; simpl; lra.
    + destruct k; simpl; [rewrite plus_IZR, !mult_IZR; ring | apply IH].
Qed.

Lemma image_zero columns : forall x k, (forall j, x j = 0) -> image columns x k = 0.
Proof.
  induction columns as [| c rest IH]; intros x k H; simpl; [reflexivity |].
  rewrite (H 0%nat), IH; [ring | intro j; apply H].
Qed.

Lemma image_of_Z columns : forall c k, image columns (of_Z c) k = IZR (nth k (zimage columns c)
  0%Z).
Proof.
  induction columns as [| col rest IH]; intros c k; simpl; [destruct k; reflexivity |].
  destruct c as [| x c].
  - rewrite image_zero; [unfold of_Z; destruct k; simpl; ring |]. intros [|]; reflexivity.
  - rewrite nth_lin, <- IH. unfold of_Z at 1. simpl. f_equal. rewrite Rmult_1_l. reflexivity.
Qed.

Lemma image_add columns : forall x y t k,
  image columns (fun j => t * x j + y j) k = t * image columns x k + image columns y k.
Proof.
  induction columns as [| c rest IH]; intros x y t k; simpl; [ring |].
  unfold tail at 1. rewrite (IH (fun j => x (S j)) (fun j => y (S j))). unfold tail. ring.
Qed.

Lemma image_ext columns : forall x y k, (forall j, x j = y j) -> image columns x k = image columns
  y k.
Proof.
  induction columns as [| c rest IH]; intros x y k H; simpl; [reflexivity |].
  rewrite (H 0%nat), (IH (tail x) (tail y)); [reflexivity | intro j; apply H].
Qed.

Lemma image_compose left right : forall x k,
  image (compose left right) x k = image left (image right x) k.
Proof.
  induction right as [| c rest IH]; intros x k; simpl.
  - symmetry. apply image_zero. reflexivity.
  - rewrite IH. rewrite <- image_of_Z. symmetry.
    apply (image_add left (of_Z c) (image rest (tail x)) (x 0%nat) k).
Qed.

(** ** Maps *)

(* x+ = (columns) x / divisor *)
Record linear := Linear { parts : list (list Z); divisor : Z }.
Definition applied (m : linear) (x : vec) : vec := fun k => / IZR (divisor m) * image (parts m) x k.

(* None leaves the state as it is. *)
Definition moved (m : option linear) (x : vec) : vec :=
  match m with None => x | Some l => applied l x end.
Definition following (m l : option linear) : option linear :=
  match m, l with
  | None, _ => l
  | _, None => m
  | Some a, Some b => Some (Linear (compose (parts a) (parts b)) (divisor a * divisor b))
  end.
Fixpoint power (m : linear) (count : nat) : option linear :=
  match count with O => None | S c => following (Some m) (power m c) end.
Fixpoint repeated (m : linear) (count : nat) (x : vec) : vec :=
  match count with O => x | S c => applied m (repeated m c x) end.

Definition pulled_back (G : sym) (m : option linear) : sym :=
  match m with None => G | Some l => congruence G (parts l) end.
Definition under (m : option linear) : Z := match m with None => 1%Z | Some l => divisor l end.

Lemma moved_following m l x k : moved (following m l) x k = moved m (moved l x) k.
Proof.
  destruct m as [a |], l as [b |]; try reflexivity. simpl. unfold applied at 1 2. simpl.
  assert (E : image (parts a) (applied b x) k
            = / IZR (divisor b) * image (parts a) (image (parts b) x) k).
  { rewrite (image_ext (parts a) _ (fun j => / IZR (divisor b) * image (parts b) x j + 0))
      by (intro; unfold applied; ring).
    rewrite image_add, (image_zero (parts a) (fun _ => 0)) by reflexivity. ring. }
  rewrite image_compose, E, mult_IZR, Rinv_mult. ring.
Qed.

Lemma applied_ext m x y k : (forall j, x j = y j) -> applied m x k = applied m y k.
Proof. intro H. unfold applied. rewrite (image_ext _ x y); auto. Qed.

Lemma moved_power m count x k : moved (power m count) x k = repeated m count x k.
Proof.
  revert k. induction count as [| c IH]; intro k; [reflexivity |].
  cbn [power repeated]. rewrite moved_following. apply applied_ext, IH.
Qed.

Lemma repeated_add m a b x : repeated m (a + b) x = repeated m a (repeated m b x).
Proof. induction a as [| a IH]; simpl; [reflexivity |]. rewrite IH. reflexivity. Qed.

Lemma quad_moved G m x : (0 < under m)%Z ->
  quad (pulled_back G m) x = IZR (under m) * IZR (under m) * quad G (moved m x).
Proof.
  intro P. apply (IZR_lt 0) in P. destruct m as [l |]; simpl in *; [| ring].
  rewrite quad_congruence. unfold applied. rewrite quad_times. field. lra.
Qed.

(* G after the map is at most (a / b)^2 times F before it. *)
Definition remainder (a b : Z) (F G : sym) (m : option linear) : sym :=
  slin (a * under m * (a * under m)) F (- (b * b)) (pulled_back G m).

Lemma remainder_quad a b F G m x : (0 < b)%Z -> (0 < under m)%Z ->
  0 <= quad (remainder a b F G m) x ->
  quad G (moved m x) <= (IZR a / IZR b) * (IZR a / IZR b) * quad F x.
Proof.
  intros B U. unfold remainder. rewrite quad_lin, quad_moved, opp_IZR, !mult_IZR by exact U.
  apply (IZR_lt 0) in B, U. set (u := IZR (under m)) in *. set (b' := IZR b) in *. intro H.
  apply Rmult_le_reg_l with (b' * b' * (u * u)); [repeat apply Rmult_lt_0_compat; assumption |].
  replace (b' * b' * (u * u) * (IZR a / b' * (IZR a / b') * quad F x))
    with (IZR a * u * (IZR a * u) * quad F x) by (field; lra).
  lra.
Qed.

Definition leads (a b : Z) (F G : sym) (m : option linear) : bool :=
  (0 <? b)%Z && (0 <? under m)%Z
  && (if positive (remainder a b F G m) then true else nonnegative (remainder a b F G m)).

Lemma leads_sound a b F G m x : leads a b F G m = true ->
  quad G (moved m x) <= (IZR a / IZR b) * (IZR a / IZR b) * quad F x.
Proof.
  unfold leads. rewrite !andb_true_iff, !Z.ltb_lt. intros [[B U] H].
  apply remainder_quad; auto. destruct (positive (remainder a b F G m)) eqn:E;
    [apply positive_sound, E | apply nonnegative_sound, H].
Qed.

Definition exceeds (factor : Z) (F : sym) : bool :=
  positive (lowered (length F) (map (zrow factor) F)).

Lemma exceeds_sound factor F x : exceeds factor F = true ->
  norm2 (length F) x <= IZR factor * quad F x.
Proof.
  intro P. pose proof (positive_sound _ P x) as Q. rewrite quad_lowered, quad_scale in Q. lra.
Qed.
