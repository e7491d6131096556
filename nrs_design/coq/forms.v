From Coq Require Import Reals ZArith List Bool Lra Lia Psatz.
Import ListNotations.
Open Scope R_scope.

(* Hexadecimal digits of long integers, the last one first. *)
Definition h0 (p : positive) : positive := p~0~0~0~0%positive.
Definition h1 (p : positive) : positive := p~0~0~0~1%positive.
Definition h2 (p : positive) : positive := p~0~0~1~0%positive.
Definition h3 (p : positive) : positive := p~0~0~1~1%positive.
Definition h4 (p : positive) : positive := p~0~1~0~0%positive.
Definition h5 (p : positive) : positive := p~0~1~0~1%positive.
Definition h6 (p : positive) : positive := p~0~1~1~0%positive.
Definition h7 (p : positive) : positive := p~0~1~1~1%positive.
Definition h8 (p : positive) : positive := p~1~0~0~0%positive.
Definition h9 (p : positive) : positive := p~1~0~0~1%positive.
Definition hA (p : positive) : positive := p~1~0~1~0%positive.
Definition hB (p : positive) : positive := p~1~0~1~1%positive.
Definition hC (p : positive) : positive := p~1~1~0~0%positive.
Definition hD (p : positive) : positive := p~1~1~0~1%positive.
Definition hE (p : positive) : positive := p~1~1~1~0%positive.
Definition hF (p : positive) : positive := p~1~1~1~1%positive.

(** ** Vectors and quadratic forms *)

(* A vector is a function of the index; forms look at as many entries as they have rows. *)
Definition vec := nat -> R.
Definition tail (x : vec) : vec := fun k => x (S k).

(* Of a row of integers and a vector. *)
Fixpoint dot (r : list Z) (x : vec) : R :=
  match r with [] => 0 | c :: r' => IZR c * x 0%nat + dot r' (tail x) end.

(* A symmetric matrix: of every row the diagonal entry, and what is right of it. *)
Definition sym := list (Z * list Z).

(* x' T x *)
Fixpoint quad (T : sym) (x : vec) : R :=
  match T with
  | [] => 0
  | (p, r) :: T' => IZR p * x 0%nat * x 0%nat + 2 * x 0%nat * dot r (tail x) + quad T' (tail x)
  end.

(* The sum of the squares of the first n entries. *)
Fixpoint norm2 (n : nat) (x : vec) : R :=
  match n with O => 0 | S m => x 0%nat * x 0%nat + norm2 m (tail x) end.

(** ** Arithmetic on them; what is missing counts as zero *)

Fixpoint zlin (p : Z) (a : list Z) (q : Z) (b : list Z) : list Z :=
  match a, b with
  | [], _ => map (Z.mul q) b
  | _, [] => map (Z.mul p) a
  | x :: a', y :: b' => (p * x + q * y)%Z :: zlin p a' q b'
  end.

Fixpoint zdot (a b : list Z) : Z :=
  match a, b with x :: a', y :: b' => (x * y + zdot a' b')%Z | _, _ => 0%Z end.

Definition zrow (p : Z) (row : Z * list Z) := ((p * fst row)%Z, map (Z.mul p) (snd row)).

(* p T + q U *)
Fixpoint slin (p : Z) (T : sym) (q : Z) (U : sym) : sym :=
  match T, U with
  | [], _ => map (zrow q) U
  | _, [] => map (zrow p) T
  | (t, r) :: T', (u, s) :: U' => ((p * t + q * u)%Z, zlin p r q s) :: slin p T' q U'
  end.

(* The square of a linear form. *)
Fixpoint square (r : list Z) : sym :=
  match r with [] => [] | c :: r' => ((c * c)%Z, map (Z.mul c) r') :: square r' end.

(* The form of x where its argument is diag(d) x. *)
Fixpoint zpair (r d : list Z) : list Z :=
  match r, d with x :: r', y :: d' => (x * y)%Z :: zpair r' d' | _, _ => [] end.
Fixpoint scaled (d : list Z) (T : sym) : sym :=
  match d, T with
  | e :: d', (p, r) :: T' => ((e * e * p)%Z, map (Z.mul e) (zpair r d')) :: scaled d' T'
  | _, _ => []
  end.

(* T c *)
Fixpoint times (T : sym) (c : list Z) : list Z :=
  match T with
  | [] => []
  | (p, r) :: T' =>
      (p * hd 0%Z c + zdot r (tl c))%Z :: zlin (hd 0%Z c) r 1 (times T' (tl c))
  end.

(* M' T M for a matrix M of columns. *)
Fixpoint congruence (T : sym) (columns : list (list Z)) : sym :=
  match columns with
  | [] => []
  | c :: rest => let u := times T c in (zdot u c, map (zdot u) rest) :: congruence T rest
  end.

(* M x *)
Fixpoint image (columns : list (list Z)) (x : vec) : vec :=
  match columns with
  | [] => fun _ => 0
  | c :: rest => fun k => x 0%nat * IZR (nth k c 0%Z) + image rest (tail x) k
  end.

Fixpoint bilin (T : sym) (x y : vec) : R :=
  match T with
  | [] => 0
  | (p, r) :: T' =>
      IZR p * x 0%nat * y 0%nat + x 0%nat * dot r (tail y) + y 0%nat * dot r (tail x)
      + bilin T' (tail x) (tail y)
  end.

Definition of_Z (c : list Z) : vec := fun k => IZR (nth k c 0%Z).

Lemma dot_ext r : forall x y, (forall k, x k = y k) -> dot r x = dot r y.
Proof.
  induction r as [| c r IH]; intros x y H; simpl; [reflexivity |].
  rewrite (H 0%nat), (IH (tail x) (tail y)); [reflexivity | intro k; apply H].
Qed.

Lemma dot_zero r : forall x, (forall k, x k = 0) -> dot r x = 0.
Proof.
  induction r as [| c r IH]; intros x H; simpl; [reflexivity |].
  rewrite (H 0%nat), IH; [lra | intro k; apply H].
Qed.

(* A vector behind the first n entries of another. *)
Definition joined (n : nat) (x e : vec) : vec :=
  fun k => if (k <? n)%nat then x k else e (k - n)%nat.

(* Whether a form is one of n entries. *)
Fixpoint shaped (n : nat) (F : sym) : bool :=
  match n, F with
  | O, [] => true
  | S k, (_, r) :: F' => (length r =? k)%nat && shaped k F'
  | _, _ => false
  end.

Lemma dot_ext_below r : forall x y,
  (forall k, (k < length r)%nat -> x k = y k) -> dot r x = dot r y.
Proof.
  induction r as [| c r IH]; intros x y H; simpl in *; [reflexivity |].
  rewrite (H 0%nat), (IH (tail x) (tail y)); [reflexivity | | lia].
  intros k K. apply H. lia.
Qed.

Lemma quad_ext_below n : forall F x y, shaped n F = true ->
  (forall k, (k < n)%nat -> x k = y k) -> quad F x = quad F y.
Proof.
  induction n as [| n IH]; intros [| [c r] F] x y S H; simpl in *; try discriminate; [reflexivity
    |].
  apply andb_true_iff in S. destruct S as [L S]. apply Nat.eqb_eq in L.
  rewrite (H 0%nat), (IH F (tail x) (tail y)), (dot_ext_below r (tail x) (tail y)); auto; try lia;
    intros k K; apply H; lia.
Qed.

Lemma norm2_ext n : forall x y, (forall k, x k = y k) -> norm2 n x = norm2 n y.
Proof.
  induction n as [| n IH]; intros x y H; simpl; [reflexivity |].
  rewrite (H 0%nat), (IH (tail x) (tail y)); [reflexivity | intro k; apply H].
Qed.

Lemma quad_ext T : forall x y, (forall k, x k = y k) -> quad T x = quad T y.
Proof.
  induction T as [| [p r] T IH]; intros x y H; simpl; [reflexivity |].
  rewrite (H 0%nat), (dot_ext r (tail x) (tail y)), (IH (tail x) (tail y));
    [reflexivity | intro k; apply H ..].
Qed.

Lemma bilin_ext T : forall x y u v,
  (forall k, x k = u k) -> (forall k, y k = v k) -> bilin T x y = bilin T u v.
Proof.
  induction T as [| [p r] T IH]; intros x y u v H K; simpl; [reflexivity |].
  rewrite (H 0%nat), (K 0%nat), (dot_ext r (tail x) (tail u)), (dot_ext r (tail y) (tail v)),
    (IH (tail x) (tail y) (tail u) (tail v));
    [reflexivity | intro k; first [apply H | apply K] ..].
Qed.

Lemma dot_scale p r : forall x, dot (map (Z.mul p) r) x = IZR p * dot r x.
Proof.
  induction r as [| c r IH]; intro x; simpl; [lra |]. rewrite IH, mult_IZR. ring.
Qed.

Lemma dot_lin p q a : forall b x, dot (zlin p a q b) x = IZR p * dot a x + IZR q * dot b x.
Proof.
  induction a as [| c a IH]; intros [| d b] x; simpl; rewrite ?dot_scale; try lra.
  - rewrite mult_IZR. ring.
  - rewrite mult_IZR. ring.
  - rewrite IH, plus_IZR, !mult_IZR. ring.
Qed.

Lemma dot_add r : forall x y t, dot r (fun k => t * x k + y k) = t * dot r x + dot r y.
Proof.
  induction r as [| c r IH]; intros x y t; simpl; [lra |].
  unfold tail at 1. rewrite (IH (fun k => x (S k)) (fun k => y (S k)) t). unfold tail. ring.
Qed.

Lemma quad_scale p T : forall x, quad (map (zrow p) T) x = IZR p * quad T x.
Proof.
  induction T as [| [t r] T IH]; intro x; simpl; [lra |].
  rewrite IH, dot_scale, mult_IZR. ring.
Qed.

Lemma quad_lin p q T : forall U x, quad (slin p T q U) x = IZR p * quad T x + IZR q * quad U x.
Proof.
  induction T as [| [t r] T IH]; intros [| [u s] U] x; simpl;
    rewrite ?quad_scale, ?dot_scale; try lra.
  - rewrite mult_IZR. ring.
  - rewrite mult_IZR. ring.
  - rewrite IH, dot_lin, plus_IZR, !mult_IZR. ring.
Qed.

Lemma quad_square r : forall x, quad (square r) x = dot r x * dot r x.
Proof.
  induction r as [| c r IH]; intro x; simpl; [lra |].
  rewrite IH, dot_scale, mult_IZR. ring.
Qed.

Lemma quad_times T : forall t x, quad T (fun k => t * x k) = t * t * quad T x.
Proof.
  induction T as [| [c r] T IH]; intros t x; simpl; [ring |].
  change (tail (fun k => t * x k)) with (fun k => t * tail x k). rewrite IH.
  rewrite (dot_ext r _ (fun k => t * tail x k + 0)) by (intro; ring).
  rewrite (dot_add r (tail x) (fun _ => 0)), (dot_zero r (fun _ => 0)) by reflexivity. ring.
Qed.

Lemma dot_pair r : forall d x, dot (zpair r d) x = dot r (fun k => IZR (nth k d 0%Z) * x k).
Proof.
  induction r as [| c r IH]; intros [| e d] x; simpl; try reflexivity.
  - rewrite dot_zero; [lra | intro k; unfold tail; lra].
  - rewrite IH, mult_IZR. unfold tail. ring.
Qed.

Lemma quad_zero T : forall x, (forall k, x k = 0) -> quad T x = 0.
Proof.
  induction T as [| [p r] T IH]; intros x H; simpl; [reflexivity |].
  rewrite (H 0%nat), IH; [lra | intro k; apply H].
Qed.

Lemma quad_scaled d : forall T x, quad (scaled d T) x = quad T (fun k => IZR (nth k d 0%Z) * x k).
Proof.
  induction d as [| e d IH]; intros T x.
  - symmetry. apply quad_zero. intro k. destruct k; simpl; lra.
  - destruct T as [| [p r] T]; simpl; [reflexivity |].
    rewrite IH, dot_scale, dot_pair, !mult_IZR. unfold tail. simpl. ring.
Qed.

Lemma bilin_self T : forall x, bilin T x x = quad T x.
Proof. induction T as [| [p r] T IH]; intro x; simpl; [reflexivity |]. rewrite IH. ring. Qed.

Lemma bilin_add T : forall x y z t,
  bilin T (fun k => t * x k + y k) z = t * bilin T x z + bilin T y z.
Proof.
  induction T as [| [p r] T IH]; intros x y z t; simpl; [lra |].
  unfold tail at 2 3.
  rewrite (IH (fun k => x (S k)) (fun k => y (S k))), (dot_add r (fun k => x (S k))).
  unfold tail. ring.
Qed.

Lemma bilin_comm T : forall x y, bilin T x y = bilin T y x.
Proof. induction T as [| [p r] T IH]; intros x y; simpl; [reflexivity |]. rewrite IH. ring. Qed.

Lemma zdot_dot a : forall b, IZR (zdot a b) = dot a (of_Z b).
Proof.
  induction a as [| x a IH]; intros [| y b]; simpl; try reflexivity.
  - rewrite dot_zero; [unfold of_Z; simpl; lra |].
    intro k. unfold tail, of_Z. destruct k; reflexivity.
  - rewrite plus_IZR, mult_IZR, IH. unfold of_Z at 2. simpl. f_equal.
Qed.

Lemma dot_times T : forall c x, dot (times T c) x = bilin T (of_Z c) x.
Proof.
  induction T as [| [p r] T IH]; intros c x; simpl; [reflexivity |].
  rewrite dot_lin, IH, plus_IZR, mult_IZR, zdot_dot.
  assert (E : forall k, of_Z (tl c) k = tail (of_Z c) k).
  { intro k. unfold of_Z, tail. destruct c as [| ? ?]; destruct k; reflexivity. }
  rewrite (dot_ext r _ _ E), (bilin_ext T _ _ _ _ E (fun k => eq_refl (tail x k))).
  replace (of_Z c 0%nat) with (IZR (hd 0%Z c)) by (unfold of_Z; destruct c; reflexivity).
  ring.
Qed.

Lemma dot_image u columns : forall x, dot u (image columns x) = dot (map (zdot u) columns) x.
Proof.
  induction columns as [| c rest IH]; intro x; simpl.
  - apply dot_zero. reflexivity.
  - rewrite (dot_add u (of_Z c)), IH, zdot_dot. ring.
Qed.

Theorem quad_congruence T columns : forall x,
  quad (congruence T columns) x = quad T (image columns x).
Proof.
  induction columns as [| c rest IH]; intro x; simpl.
  - rewrite quad_zero; auto.
  - rewrite IH, <- dot_image, dot_times, zdot_dot, dot_times.
    set (w := image rest (tail x)). set (v := of_Z c). set (t := x 0%nat).
    change (fun k => t * IZR (nth k c 0%Z) + w k) with (fun k => t * v k + w k).
    rewrite <- (bilin_self T (fun k => t * v k + w k)), bilin_add.
    rewrite (bilin_comm T v (fun k => t * v k + w k)), (bilin_comm T w (fun k => t * v k + w k)).
    rewrite !bilin_add, <- (bilin_self T w), (bilin_comm T w v). ring.
Qed.

(** ** Lists *)

(* Like forallb, but the first that fails is the last that is computed. *)
Fixpoint every {A : Type} (f : A -> bool) (l : list A) : bool :=
  match l with [] => true | a :: l' => if f a then every f l' else false end.

Lemma every_sound {A : Type} (f : A -> bool) l : every f l = true -> forall a, In a l -> f a = true.
Proof.
  induction l as [| b l IH]; simpl; [tauto |]. destruct (f b) eqn:E; [| discriminate].
  intros H a [<- | I]; [exact E | exact (IH H a I)].
Qed.

(** ** Averages *)

Definition squared (x : vec) : vec := fun k => x k * x k.
Definition mix (a : R) (v u : vec) : vec := fun k => (1 - a) * v k + a * u k.

(* Where T is nowhere negative, it is convex. *)
Lemma quad_convex T a v u : (forall x, 0 <= quad T x) -> 0 <= a <= 1 ->
  quad T (mix a v u) <= (1 - a) * quad T v + a * quad T u.
Proof.
  intros P A. set (w := fun k => u k - v k).
  assert (E : forall t, quad T (fun k => t * w k + v k) = t * t * quad T w + 2 * t * bilin T w v +
    quad T v).
  { intro t. rewrite <- bilin_self, bilin_add, (bilin_comm T w), (bilin_comm T v), !bilin_add,
      !bilin_self, (bilin_comm T v w). ring. }
  rewrite (quad_ext T (mix a v u) (fun k => a * w k + v k)) by (intro; unfold mix, w; ring).
  rewrite (quad_ext T u (fun k => 1 * w k + v k)) by (intro; unfold w; ring).
  rewrite !E. specialize (P w).
  assert (0 <= a * (1 - a) * quad T w) by (apply Rmult_le_pos; [apply Rmult_le_pos |]; lra).
  nra.
Qed.

Lemma limits_convex ms a : 0 <= a <= 1 -> forallb (Z.leb 0) ms = true -> forall e l m : vec,
  (1 - a) * dot ms (fun i => squared e i - squared l i) + a * dot ms (fun i => squared e i -
    squared m i)
  <= dot ms (fun i => squared e i - squared (fun j => (1 - a) * l j + a * m j) i).
Proof.
  intro A. induction ms as [| c ms IH]; intros P e l m; cbn [dot forallb] in *; [lra |].
  apply andb_true_iff in P. destruct P as [C P]. apply Z.leb_le, (IZR_le 0) in C.
  specialize (IH P (tail e) (tail l) (tail m)). unfold tail, squared in *.
  assert (0 <= IZR c * (a * (1 - a) * ((l 0%nat - m 0%nat) * (l 0%nat - m 0%nat)))).
  { apply Rmult_le_pos; [exact C |]. apply Rmult_le_pos; [apply Rmult_le_pos; lra |].
    apply Rle_0_sqr. }
  nra.
Qed.

(** ** Positive forms, decided by elimination in integers of bounded length *)

(* Of the first m diagonal entries, one less. *)
Fixpoint lowered (m : nat) (T : sym) : sym :=
  match m, T with
  | O, _ => T
  | S m', [] => ((-1)%Z, []) :: lowered m' []
  | S m', (p, r) :: T' => ((p - 1)%Z, r) :: lowered m' T'
  end.

(* Every entry over two to the power of a number for its row and one for its column, rounded
   down. What is lost is less than one each, and is taken from the diagonal. *)
Fixpoint rounded_row (s : Z) (r ss : list Z) : list Z :=
  match r with
  | [] => []
  | c :: r' => Z.shiftr c (s + hd 0%Z ss) :: rounded_row s r' (tl ss)
  end.
Fixpoint rounded (ss : list Z) (T : sym) : sym :=
  match T with
  | [] => []
  | (p, r) :: T' =>
      let s := hd 0%Z ss in
      ((Z.shiftr p (s + s) - Z.of_nat (length r))%Z, rounded_row s r (tl ss))
        :: lowered (length r) (rounded (tl ss) T')
  end.

(* So that about so many bits are left of every diagonal entry. *)
Definition excess (bits : Z) (row : Z * list Z) : Z :=
  Z.max 0 (Z.shiftr (Z.log2 (fst row) - bits) 1).
Definition shortened (bits : Z) (T : sym) : sym := rounded (map (excess bits) T) T.

Fixpoint eliminated (bits : Z) (fuel : nat) (T : sym) : bool :=
  match fuel, shortened bits T with
  | _, [] => true
  | S fuel', (p, r) :: T' =>
      if (0 <? p)%Z then eliminated bits fuel' (slin p T' (-1) (square r)) else false
  | O, _ => false
  end.

(* With more bits, more forms are found to be positive. *)
Fixpoint found_positive (tried : list Z) (T : sym) : bool :=
  match tried with
  | [] => false
  | bits :: rest =>
      if eliminated bits (length T) (map (zrow (2 ^ (2 * bits))) T) then true
      else found_positive rest T
  end.
Definition positive : sym -> bool := found_positive [32; 64; 128; 256]%Z.

Lemma quad_lowered m : forall T x, quad (lowered m T) x = quad T x - norm2 m x.
Proof.
  induction m as [| m IH]; intros T x; simpl; [lra |].
  destruct T as [| [p r] T]; simpl; rewrite IH; simpl; [lra |]. rewrite minus_IZR. ring.
Qed.

(* 2^s as a real number. *)
Definition two (s : Z) : R := IZR (2 ^ s).

Lemma two_plus a b : (0 <= a)%Z -> (0 <= b)%Z -> two (a + b) = two a * two b.
Proof. intros. unfold two. rewrite Z.pow_add_r, mult_IZR; auto. Qed.

Lemma two_positive s : (0 <= s)%Z -> 0 < two s.
Proof. intro. apply (IZR_lt 0), Z.pow_pos_nonneg; lia. Qed.

Lemma shiftr_bounds c s : (0 <= s)%Z ->
  two s * IZR (Z.shiftr c s) <= IZR c <= two s * (IZR (Z.shiftr c s) + 1).
Proof.
  intro Hs. rewrite Z.shiftr_div_pow2 by assumption. unfold two.
  assert (P : (0 < 2 ^ s)%Z) by (apply Z.pow_pos_nonneg; lia).
  rewrite <- (plus_IZR _ 1), <- !mult_IZR.
  pose proof (Z.div_mod c (2 ^ s) ltac:(lia)). pose proof (Z.mod_pos_bound c (2 ^ s) P).
  split; apply IZR_le; nia.
Qed.

(* A vector in units of two to a power each. *)
Definition counted (ss : list Z) (x : vec) : vec := fun k => two (nth k ss 0%Z) * x k.

Definition natural (ss : list Z) := Forall (fun s => (0 <= s)%Z) ss.

Lemma natural_tl ss : natural ss -> natural (tl ss).
Proof. intro H. destruct H; [constructor | assumption]. Qed.

Lemma natural_hd ss : natural ss -> (0 <= hd 0 ss)%Z.
Proof. intro H. destruct H; simpl; [lia | assumption]. Qed.

Lemma counted_tail ss x : forall k, counted (tl ss) (tail x) k = tail (counted ss x) k.
Proof. intro k. unfold counted, tail. destruct ss; destruct k; reflexivity. Qed.

Lemma counted_head ss x : counted ss x 0%nat = two (hd 0%Z ss) * x 0%nat.
Proof. unfold counted. destruct ss; reflexivity. Qed.

Lemma rounded_row_below s r : (0 <= s)%Z -> forall ss x x0, natural ss ->
  let y := counted ss x in let y0 := two s * x0 in
  2 * y0 * dot (rounded_row s r ss) y - INR (length r) * (y0 * y0) - norm2 (length r) y
  <= 2 * x0 * dot r x.
Proof.
  intro Hs. induction r as [| c r IH]; intros ss x x0 N; cbn zeta.
  - simpl. lra.
  - cbn [length rounded_row dot norm2]. rewrite S_INR.
    specialize (IH (tl ss) (tail x) x0 (natural_tl ss N)). cbn zeta in IH.
    rewrite (dot_ext _ _ _ (counted_tail ss x)) in IH.
    rewrite (norm2_ext _ _ _ (counted_tail ss x)) in IH. rewrite counted_head.
    pose proof (natural_hd ss N) as Hh. pose proof (shiftr_bounds c (s + hd 0%Z ss) ltac:(lia)) as
      B.
    rewrite two_plus in B by assumption.
    set (a := two s * x0) in *. set (b := two (hd 0%Z ss) * x 0%nat).
    set (v := IZR (Z.shiftr c (s + hd 0%Z ss))) in *.
    assert (K : 2 * a * (v * b) - (a * a + b * b) <= 2 * x0 * (IZR c * x 0%nat)).
    { pose proof (two_positive s Hs) as P. pose proof (two_positive _ Hh) as Q.
      set (w := two s * two (hd 0%Z ss)) in *.
      assert (W : 0 < w) by (apply Rmult_lt_0_compat; assumption).
      (* c = w (v + e) with e from 0 to 1 *)
      destruct (ex_intro (fun e => IZR c = w * (v + e)) (IZR c / w - v)) as [e C]; [field; lra |].
      rewrite C in B.
      assert (E0 : 0 <= e) by (apply Rmult_le_reg_l with w; [assumption | lra]).
      assert (E1 : e <= 1) by (apply Rmult_le_reg_l with w; [assumption | lra]).
      rewrite C. replace (2 * x0 * (w * (v + e) * x 0%nat)) with (2 * a * (v * b) + 2 * e * a * b)
        by (unfold a, b, w; ring).
      assert (0 <= a * a + b * b + 2 * e * a * b).
      { replace (a * a + b * b + 2 * e * a * b)
          with (e * ((a + b) * (a + b)) + (1 - e) * (a * a + b * b)) by ring.
        assert (0 <= a * a + b * b) by (apply Rplus_le_le_0_compat; apply Rle_0_sqr).
        pose proof (Rle_0_sqr (a + b)) as R0. unfold Rsqr in R0.
        apply Rplus_le_le_0_compat; apply Rmult_le_pos; lra. }
      lra. }
    lra.
Qed.

Lemma rounded_below T : forall ss x, natural ss ->
  quad (rounded ss T) (counted ss x) <= quad T x.
Proof.
  induction T as [| [p r] T IH]; intros ss x N; [apply Rle_refl |].
  cbn [rounded quad]. rewrite quad_lowered, minus_IZR, <- INR_IZR_INZ.
  pose proof (natural_hd ss N) as Hh. pose proof (natural_tl ss N) as N'.
  specialize (IH (tl ss) (tail x) N').
  rewrite (quad_ext _ _ _ (counted_tail ss x)) in IH.
  pose proof (rounded_row_below (hd 0%Z ss) r Hh (tl ss) (tail x) (x 0%nat) N') as B. cbn zeta in B.
  rewrite (dot_ext _ _ _ (counted_tail ss x)) in B.
  rewrite (norm2_ext _ _ _ (counted_tail ss x)) in B. rewrite counted_head.
  pose proof (shiftr_bounds p (hd 0%Z ss + hd 0%Z ss) ltac:(lia)) as D.
  rewrite two_plus in D by assumption.
  set (t := two (hd 0%Z ss)) in *. set (v := IZR (Z.shiftr p (hd 0%Z ss + hd 0%Z ss))) in *.
  assert (v * (t * x 0%nat) * (t * x 0%nat) <= IZR p * x 0%nat * x 0%nat).
  { pose proof (Rle_0_sqr (x 0%nat)) as R0. unfold Rsqr in R0. nra. }
  lra.
Qed.

Lemma excess_natural bits T : natural (map (excess bits) T).
Proof.
  induction T as [| row T IH]; [constructor |].
  constructor; [unfold excess; apply Z.le_max_l | exact IH].
Qed.

Lemma shortened_below bits T x : exists y, quad (shortened bits T) y <= quad T x.
Proof.
  exists (counted (map (excess bits) T) x). apply rounded_below, excess_natural.
Qed.

Lemma eliminated_positive bits fuel : forall T,
  eliminated bits fuel T = true -> forall x, 0 <= quad T x.
Proof.
  induction fuel as [| fuel IH]; intros T H x;
    destruct (shortened_below bits T x) as [y Hy]; simpl in H;
    destruct (shortened bits T) as [| [p r] S]; simpl in Hy; try lra; try discriminate.
  destruct (Z.ltb_spec 0 p) as [P |]; [| discriminate]. apply (IZR_lt 0) in P.
  pose proof (IH _ H (tail y)) as Q. rewrite quad_lin, quad_square in Q.
  set (s := dot r (tail y)) in *. set (q := quad S (tail y)) in *. set (a := y 0%nat) in *.
  enough (0 <= IZR p * a * a + 2 * a * s + q) by lra.
  apply Rmult_le_reg_l with (IZR p); [assumption |]. rewrite Rmult_0_r.
  replace (IZR p * (IZR p * a * a + 2 * a * s + q))
    with ((IZR p * a + s) * (IZR p * a + s) + (IZR p * q + -1 * (s * s))) by ring.
  pose proof (Rle_0_sqr (IZR p * a + s)) as R0. unfold Rsqr in R0. lra.
Qed.

Theorem positive_sound T : positive T = true -> forall x, 0 <= quad T x.
Proof.
  unfold positive. assert (P : Forall (Z.le 0) [32; 64; 128; 256]%Z) by (repeat constructor; lia).
  induction P as [| bits rest B _ IH]; simpl; [discriminate |]. intros H x.
  destruct (eliminated bits _ _) eqn:E; [| exact (IH H x)].
  pose proof (eliminated_positive _ _ _ E x) as Q. rewrite quad_scale in Q.
  apply Rmult_le_reg_l with (two (2 * bits)); [apply two_positive; lia |].
  unfold two in *. simpl in *. lra.
Qed.
