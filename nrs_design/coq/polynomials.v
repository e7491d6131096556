(** ** Polynomials in the states *)

(* A monomial is the list of its variables, in order; a polynomial is a list of terms. *)
Definition mono := list nat.
Definition poly := list (Z * mono).

Fixpoint meval (m : mono) (x : vec) : R := match m with [] => 1 | i :: m' => x i * meval m' x end.
Fixpoint peval (P : poly) (x : vec) : R :=
  match P with [] => 0 | (c, m) :: P' => IZR c * meval m x + peval P' x end.

Fixpoint insert (i : nat) (m : mono) : mono :=
  match m with [] => [i] | j :: m' => if (i <=? j)%nat then i :: m else j :: insert i m' end.
Definition product (a b : mono) : mono := fold_right insert b a.
Definition pscale (c : Z) (P : poly) : poly := map (fun '(d, m) => ((c * d)%Z, m)) P.
Definition ptimes (i : nat) (P : poly) : poly := map (fun '(d, m) => (d, insert i m)) P.

Fixpoint add_term (c : Z) (m : mono) (P : poly) : poly :=
  match P with
  | [] => [(c, m)]
  | (d, n) :: P' =>
      if list_eq_dec Nat.eq_dec m n then ((c + d)%Z, n) :: P' else (d, n) :: add_term c m P'
  end.
Definition collected (P : poly) : poly := fold_right (fun '(c, m) Q => add_term c m Q) [] P.
Definition vanishes (P : poly) : bool := forallb (fun '(c, _) => (c =? 0)%Z) (collected P).

(* z' T z for the monomials z of a basis. *)
Definition monomials (basis : list mono) (x : vec) : vec :=
  fun k => match nth_error basis k with Some m => meval m x | None => 0 end.
Fixpoint cross (m : mono) (r : list Z) (basis : list mono) : poly :=
  match r, basis with
  | c :: r', b :: basis' => (c, product m b) :: cross m r' basis'
  | _, _ => []
  end.
Fixpoint expanded (T : sym) (basis : list mono) : poly :=
  match T, basis with
  | (p, r) :: T', m :: basis' =>
      (p, product m m) :: pscale 2 (cross m r basis') ++ expanded T' basis'
  | _, _ => []
  end.

(* Derivative along x' = (rows) x. *)
Fixpoint row_terms (k : nat) (row : list Z) : poly :=
  match row with [] => [] | c :: row' => (c, [k]) :: row_terms (S k) row' end.
Fixpoint mono_along (rows : list (list Z)) (m : mono) : poly :=
  match m with
  | [] => []
  | i :: m' =>
      map (fun '(c, j) => (c, product j m')) (row_terms 0 (nth i rows []))
      ++ ptimes i (mono_along rows m')
  end.
Definition along (rows : list (list Z)) (P : poly) : poly :=
  flat_map (fun '(c, m) => pscale c (mono_along rows m)) P.

Lemma meval_insert i m x : meval (insert i m) x = x i * meval m x.
Proof.
  induction m as [| j m IH]; simpl; [ring |].
  destruct (i <=? j)%nat; simpl; [ring |]. rewrite IH. ring.
Qed.

Lemma meval_product a b x : meval (product a b) x = meval a x * meval b x.
Proof. induction a as [| i a IH]; simpl; [ring |]. rewrite meval_insert, IH. ring. Qed.

Lemma peval_app P Q x : peval (P ++ Q) x = peval P x + peval Q x.
Proof. induction P as [| [c m] P IH]; simpl; [ring |]. rewrite IH. ring. Qed.

Lemma peval_scale c P x : peval (pscale c P) x = IZR c * peval P x.
Proof. induction P as [| [d m] P IH]; simpl; [ring |]. rewrite IH, mult_IZR. ring. Qed.

Lemma peval_times i P x : peval (ptimes i P) x = x i * peval P x.
Proof. induction P as [| [d m] P IH]; simpl; [ring |]. rewrite IH, meval_insert. ring. Qed.

Lemma peval_add_term c m P x : peval (add_term c m P) x = IZR c * meval m x + peval P x.
Proof.
  induction P as [| [d n] P IH]; simpl; [ring |].
  destruct (list_eq_dec Nat.eq_dec m n) as [<- |]; simpl; [rewrite plus_IZR | rewrite IH]; ring.
Qed.

Lemma peval_collected P x : peval (collected P) x = peval P x.
Proof. induction P as [| [c m] P IH]; simpl; [ring |]. rewrite peval_add_term, IH. ring. Qed.

Lemma vanishes_sound P x : vanishes P = true -> peval P x = 0.
Proof.
  unfold vanishes. rewrite <- (peval_collected P x). induction (collected P) as [| [c m] Q IH];
    simpl; [reflexivity |]. rewrite andb_true_iff, Z.eqb_eq. intros [-> H]. rewrite IH; auto. ring.
Qed.

Lemma peval_cross m r : forall basis x,
  peval (cross m r basis) x = meval m x * dot r (monomials basis x).
Proof.
  induction r as [| c r IH]; intros [| b basis] x; simpl; try ring.
  - rewrite dot_zero; [unfold monomials; simpl; ring |]. intro k. unfold tail, monomials.
    destruct k; reflexivity.
  - rewrite IH, meval_product. unfold monomials at 2. simpl.
    change (tail (monomials (b :: basis) x)) with (monomials basis x). ring.
Qed.

Lemma peval_expanded T : forall basis x, peval (expanded T basis) x = quad T (monomials basis x).
Proof.
  induction T as [| [p r] T IH]; intros [| m basis] x; simpl; try reflexivity.
  - symmetry. rewrite dot_zero, quad_zero; [unfold monomials; simpl; ring | | ];
      intro k; unfold tail, monomials; destruct k; reflexivity.
  - rewrite peval_app, peval_scale, peval_cross, IH, meval_product.
    change (tail (monomials (m :: basis) x)) with (monomials basis x).
    unfold monomials at 3 4 5. simpl. ring.
Qed.

(* The derivative of a monomial where its variables have derivatives v. *)
Fixpoint mono_slope (m : mono) (x v : vec) : R :=
  match m with [] => 0 | i :: m' => v i * meval m' x + x i * mono_slope m' x v end.
Fixpoint slope (P : poly) (x v : vec) : R :=
  match P with [] => 0 | (c, m) :: P' => IZR c * mono_slope m x v + slope P' x v end.

Lemma dot_shift row : forall k x,
  peval (row_terms k row) x = dot row (fun j => x (k + j)%nat).
Proof.
  induction row as [| c row IH]; intros k x; simpl; [reflexivity |].
  rewrite IH, Nat.add_0_r. f_equal; [ring |]. apply dot_ext. intro j. unfold tail.
  f_equal. lia.
Qed.

Lemma peval_mono_along rows m x :
  peval (mono_along rows m) x = mono_slope m x (fun i => dot (nth i rows []) x).
Proof.
  induction m as [| i m IH]; simpl; [reflexivity |].
  rewrite peval_app, peval_times, IH. f_equal.
  rewrite <- (dot_ext (nth i rows []) (fun j => x (0 + j)%nat) x), <- dot_shift by reflexivity.
  induction (row_terms 0 (nth i rows [])) as [| [c j] P IHP]; simpl; [ring |].
  rewrite IHP, meval_product. ring.
Qed.

Lemma peval_along rows P x :
  peval (along rows P) x = slope P x (fun i => dot (nth i rows []) x).
Proof.
  induction P as [| [c m] P IH]; simpl; [reflexivity |].
  rewrite peval_app, peval_scale, peval_mono_along, IH. reflexivity.
Qed.

Lemma mono_slope_times m x v t : mono_slope m x (fun i => t * v i) = t * mono_slope m x v.
Proof. induction m as [| i m IH]; simpl; [ring |]. rewrite IH. ring. Qed.

Lemma slope_times P x v t : slope P x (fun i => t * v i) = t * slope P x v.
Proof. induction P as [| [c m] P IH]; simpl; [ring |]. rewrite IH, mono_slope_times. ring. Qed.

Lemma slope_mix P x v w l :
  slope P x (fun i => (1 - l) * v i + l * w i) = (1 - l) * slope P x v + l * slope P x w.
Proof.
  induction P as [| [c m] P IH]; simpl; [ring |]. rewrite IH.
  enough (E : mono_slope m x (fun i => (1 - l) * v i + l * w i)
            = (1 - l) * mono_slope m x v + l * mono_slope m x w) by (rewrite E; ring).
  clear. induction m as [| i m IH]; simpl; [ring |]. rewrite IH. ring.
Qed.

(** ** What has a derivative from the right that is never positive does not grow *)

Definition right (f : R -> R) (v t : R) : Prop := D_in f (fun _ => v) (fun s => t < s) t.

Lemma right_const c t : right (fun _ => c) 0 t.
Proof. apply (Dconst (fun s => t < s) c t). Qed.

Lemma right_add f g v w t : right f v t -> right g w t -> right (fun s => f s + g s) (v + w) t.
Proof. apply (Dadd (fun s => t < s) (fun _ => v) (fun _ => w) f g t). Qed.

Lemma right_times f g v w t : right f v t -> right g w t ->
  right (fun s => f s * g s) (v * g t + f t * w) t.
Proof. apply (Dmult (fun s => t < s) (fun _ => v) (fun _ => w) f g t). Qed.

Lemma right_iff f v t : right f v t <-> forall e, 0 < e ->
  exists d, 0 < d /\ forall s, t < s < t + d -> Rabs ((f s - f t) / (s - t) - v) < e.
Proof.
  unfold right, D_in, limit1_in, limit_in, D_x. simpl. unfold R_dist.
  split; intros H e E; destruct (H e E) as (d & D & K); exists d; split; auto.
  - intros s B. apply K. rewrite Rabs_right; lra.
  - intros s [[B _] C]. apply K. rewrite Rabs_right in C; lra.
Qed.

Lemma right_ext f g v t d : 0 < d -> (forall s, t <= s < t + d -> f s = g s) ->
  right f v t -> right g v t.
Proof.
  intros D E H. apply right_iff. intros e He.
  destruct (proj1 (right_iff f v t) H e He) as (d' & D' & K).
  exists (Rmin d d'). split; [apply Rmin_glb_lt; assumption |]. intros s B.
  pose proof (Rmin_l d d'). pose proof (Rmin_r d d').
  rewrite <- !E by lra. apply K. lra.
Qed.

Lemma right_derivative f v t : derivable_pt_lim f t v -> right f v t.
Proof.
  intro H. apply right_iff. intros e E. destruct (H e E) as [[d D] K]. exists d. split; auto.
  simpl in K. intros s B. specialize (K (s - t) ltac:(lra)).
  replace (t + (s - t)) with s in K by ring. apply K. rewrite Rabs_right; lra.
Qed.

Lemma never_grows f t : 0 <= t ->
  (forall s, 0 <= s < t -> exists v, right f v s /\ v <= 0) ->
  (forall s, 0 < s <= t -> continuity_pt f s) -> f t <= f 0.
Proof.
  intros T D C. apply le_epsilon. intros e E.
  set (a := e / (t + 1)). assert (A : 0 < a) by (apply Rdiv_lt_0_compat; lra).
  set (P := fun s => 0 <= s <= t /\ forall u, 0 <= u <= s -> f u <= f 0 + a * u).
  assert (P0 : P 0).
  { split; [lra |]. intros u U. replace u with 0 by lra. lra. }
  destruct (completeness P) as [c [Up Least]].
  { exists t. intros s [S _]. lra. }
  { exists 0. exact P0. }
  assert (C0 : 0 <= c) by (apply Up, P0).
  assert (Ct : c <= t) by (apply Least; intros s [S _]; lra).
  assert (Below : forall u, 0 <= u < c -> f u <= f 0 + a * u).
  { intros u U. destruct (Rle_dec (f u) (f 0 + a * u)) as [| No]; [assumption | exfalso].
    assert (c <= u); [| lra]. apply Least. intros s [S K].
    destruct (Rle_dec s u); [assumption |]. exfalso. apply No, K. lra. }
  assert (At : f c <= f 0 + a * c).
  { destruct (Req_dec c 0) as [-> | Z]; [lra |].
    apply le_epsilon. intros h H. destruct (C c ltac:(lra) h H) as (d & Dp & K).
    simpl in K. unfold R_dist, D_x, no_cond in K.
    set (u := Rmax (c / 2) (c - d / 2)).
    assert (U : c / 2 <= u /\ c - d / 2 <= u /\ u < c).
    { unfold u. split; [apply Rmax_l |]. split; [apply Rmax_r |]. apply Rmax_lub_lt; lra. }
    specialize (K u). assert (B := Below u ltac:(lra)).
    assert (Rabs (f u - f c) < h).
    { apply K. split; [split; [exact I | lra] |]. rewrite Rabs_left1; lra. }
    apply Rabs_def2 in H0. nra. }
  assert (c = t).
  { destruct (Req_dec c t) as [| Ne]; [assumption | exfalso].
    destruct (D c ltac:(lra)) as (v & Dv & N).
    destruct (proj1 (right_iff _ _ _) Dv a A) as (d & Dp & K).
    set (h := Rmin (d / 2) (t - c)).
    assert (H : 0 < h <= d / 2 /\ h <= t - c).
    { unfold h. pose proof (Rmin_l (d / 2) (t - c)). pose proof (Rmin_r (d / 2) (t - c)).
      repeat split; try assumption. apply Rmin_glb_lt; lra. }
    assert (Ph : P (c + h)); [| assert (c + h <= c) by (apply Up, Ph); lra].
    split; [lra |]. intros u U. destruct (Rle_dec u c) as [Uc | Uc].
    - destruct (Req_dec u c) as [-> |]; [exact At | apply Below; lra].
    - specialize (K u ltac:(lra)). apply Rabs_def2 in K. destruct K as [K _].
      assert (L : (f u - f c) / (u - c) <= a) by lra.
      apply (Rmult_le_compat_r (u - c)) in L; [| lra].
      replace ((f u - f c) / (u - c) * (u - c)) with (f u - f c) in L by (field; lra). lra. }
  subst c. assert (a * t <= e); [| lra].
  unfold a. apply Rmult_le_reg_r with (t + 1); [lra |].
  replace (e / (t + 1) * t * (t + 1)) with (e * t) by (field; lra). nra.
Qed.

Lemma falls_exponentially f a t : 0 <= t ->
  (forall s, 0 <= s < t -> exists v, right f v s /\ v <= - a * f s) ->
  (forall s, 0 < s <= t -> continuity_pt f s) -> f t <= exp (- a * t) * f 0.
Proof.
  intros T D C.
  assert (X : forall t, derivable_pt_lim (fun s => exp (a * s)) t (a * exp (a * t))).
  { intro s. rewrite (Rmult_comm a (exp _)).
    apply (derivable_pt_lim_comp (fun s => a * s) exp); [| apply derivable_pt_lim_exp].
    pose proof (derivable_pt_lim_scal id a s 1 (derivable_pt_lim_id s)) as L.
    rewrite Rmult_1_r in L. exact L. }
  assert (K : exp (a * t) * f t <= exp (a * 0) * f 0).
  { apply (never_grows (fun s => exp (a * s) * f s) t T).
    - intros s S. destruct (D s S) as (v & Dv & N).
      exists (a * exp (a * s) * f s + exp (a * s) * v). split.
      + apply (right_times (fun u => exp (a * u)) f); [apply right_derivative, X | exact Dv].
      + pose proof (exp_pos (a * s)). nra.
    - intros s S. apply continuity_pt_mult; [| apply C, S].
      apply derivable_continuous_pt. exists (a * exp (a * s)). apply X. }
  rewrite Rmult_0_r, exp_0, Rmult_1_l in K.
  apply Rmult_le_reg_l with (exp (a * t)); [apply exp_pos |].
  rewrite <- Rmult_assoc, <- exp_plus. replace (a * t + - a * t) with 0 by ring.
  rewrite exp_0. lra.
Qed.

Lemma right_meval m (w : R -> vec) v t : (forall i, In i m -> right (fun s => w s i) (v i) t) ->
  right (fun s => meval m (w s)) (mono_slope m (w t) v) t.
Proof.
  induction m as [| i m IH]; intro H; simpl; [apply right_const |].
  apply (right_times (fun s => w s i) (fun s => meval m (w s))); [apply H; left; reflexivity |].
  apply IH. intros j J. apply H. right. exact J.
Qed.

Lemma right_peval P (w : R -> vec) v t :
  (forall c m, In (c, m) P -> forall i, In i m -> right (fun s => w s i) (v i) t) ->
  right (fun s => peval P (w s)) (slope P (w t) v) t.
Proof.
  induction P as [| [c m] P IH]; intro H; simpl; [apply right_const |].
  apply right_add; [| apply IH; intros d k K; apply (H d k); right; exact K].
  replace (IZR c * mono_slope m (w t) v) with (0 * meval m (w t) + IZR c * mono_slope m (w t) v)
    by ring.
  apply (right_times (fun _ => IZR c) (fun s => meval m (w s))); [apply right_const |].
  apply right_meval. apply (H c m). left. reflexivity.
Qed.

Lemma continuous_ext f g t : (forall s, f s = g s) -> continuity_pt f t -> continuity_pt g t.
Proof.
  intros E H e Pe. destruct (H e Pe) as (d & D & K). exists d. split; [exact D |].
  intros s S. rewrite <- !E. apply K, S.
Qed.

Lemma continuous_meval m (w : R -> vec) t :
  (forall i, In i m -> continuity_pt (fun s => w s i) t) ->
  continuity_pt (fun s => meval m (w s)) t.
Proof.
  induction m as [| i m IH]; intro H; simpl; [apply continuity_pt_const; intros ? ?; reflexivity |].
  apply (continuity_pt_mult (fun s => w s i) (fun s => meval m (w s))).
  - apply H. left. reflexivity.
  - apply IH. intros j J. apply H. right. exact J.
Qed.

Lemma continuous_peval P (w : R -> vec) t :
  (forall c m, In (c, m) P -> forall i, In i m -> continuity_pt (fun s => w s i) t) ->
  continuity_pt (fun s => peval P (w s)) t.
Proof.
  induction P as [| [c m] P IH]; intro H; simpl;
    [apply continuity_pt_const; intros ? ?; reflexivity |].
  apply (continuity_pt_plus (fun s => IZR c * meval m (w s)) (fun s => peval P (w s))).
  - apply (continuity_pt_mult (fun _ => IZR c) (fun s => meval m (w s)));
      [apply continuity_pt_const; intros ? ?; reflexivity |].
    apply continuous_meval. apply (H c m). left. reflexivity.
  - apply IH. intros d k K. apply (H d k). right. exact K.
Qed.
