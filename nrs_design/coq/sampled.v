(** ** Sampled loops: what is claimed, and what is checked *)

(* V falls in every step, so it does in any sequence of them, and it is no smaller than a size of
   the state but for a factor. *)
Definition decays (step : vec -> vec -> Prop) (V size : vec -> R) (rho factor : R) : Prop :=
  0 <= rho < 1
  /\ (forall x y, step x y -> V y <= rho ^ 2 * V x)
  /\ (forall run : nat -> vec, (forall k, step (run k) (run (S k))) ->
      forall k, V (run k) <= rho ^ (2 * k) * V (run 0%nat))
  /\ (forall x, size x <= factor * V x).

Lemma decays_from_step (step : vec -> vec -> Prop) V size rho factor : 0 <= rho < 1 ->
  (forall x y, step x y -> V y <= rho ^ 2 * V x) -> (forall x, size x <= factor * V x) ->
  decays step V size rho factor.
Proof.
  intros B Falls N. repeat split; auto; try lra. intros run H k. induction k as [| k IH].
  - simpl. lra.
  - replace (2 * S k)%nat with (2 + 2 * k)%nat by lia. rewrite pow_add.
    apply Rle_trans with (rho ^ 2 * V (run k)); [apply Falls, H |].
    rewrite Rmult_assoc. apply Rmult_le_compat_l; [apply pow2_ge_0 | exact IH].
Qed.

(* A form, and the multipliers of what is known on steps that lead to it. *)
Record node := Node { form : sym; lost : Z; errors : list Z }.

Lemma largest_nonnegative forms x : 0 <= largest forms x.
Proof. induction forms; simpl; [lra | apply Rle_trans with (1 := IHforms), Rmax_r]. Qed.

Lemma largest_above forms x F : In F forms -> quad F x <= largest forms x.
Proof.
  induction forms as [| G forms IH]; simpl; [tauto |]. intros [-> | I]; [apply Rmax_l |].
  apply Rle_trans with (1 := IH I), Rmax_r.
Qed.

Lemma largest_below forms x v : 0 <= v -> (forall F, In F forms -> quad F x <= v) ->
  largest forms x <= v.
Proof.
  intro P. induction forms as [| G forms IH]; simpl; intro H; [exact P |].
  apply Rmax_lub; [apply H; auto | apply IH; intros; apply H; auto].
Qed.

Section Loop.
(* So many errors are made in a step. *)
Variables (p q factor : Z) (rounded : nat).
Notation rho := (IZR p / IZR q).

Definition is_slow : bool := ((0 <=? p) && (p <? q))%Z.

Lemma slow : is_slow = true -> 0 <= rho < 1 /\ (0 < q)%Z.
Proof.
  unfold is_slow. rewrite andb_true_iff, Z.leb_le, Z.ltb_lt. intros [P Q].
  pose proof (IZR_le _ _ P). pose proof (IZR_lt _ _ Q). split; [| lia].
  split; [apply Rmult_le_pos; [| left; apply Rinv_0_lt_compat]; lra |].
  apply Rmult_lt_reg_r with (IZR q); [lra |]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l; lra.
Qed.

Definition exceeds (n : nat) (F : sym) : bool :=
  shaped n F && positive (lowered n (map (zrow factor) F)).

Lemma exceeds_sound n F x : exceeds n F = true -> norm2 n x <= IZR factor * quad F x.
Proof.
  unfold exceeds. rewrite andb_true_iff. intros [_ P].
  pose proof (positive_sound _ P x) as Q. rewrite quad_lowered, quad_scale in Q. lra.
Qed.

Definition all_exceed (n : nat) (nodes : list node) : bool :=
  negb (match nodes with [] => true | _ => false end) && (0 <? factor)%Z
  && every (fun b => exceeds n (form b) && (length (errors b) =? rounded)%nat
                       && forallb (Z.leb 0) (errors b) && (0 <=? lost b)%Z) nodes.

Lemma norm2_nonnegative n : forall x, 0 <= norm2 n x.
Proof.
  induction n as [| n IH]; intro x; simpl; [lra |].
  pose proof (Rle_0_sqr (x 0%nat)) as Q. unfold Rsqr in Q. specialize (IH (tail x)). lra.
Qed.

Lemma all_exceed_each n nodes b : all_exceed n nodes = true -> In b nodes ->
  shaped n (form b) = true /\ length (errors b) = rounded /\ forallb (Z.leb 0) (errors b) = true
  /\ 0 <= IZR (lost b) /\ forall x, 0 <= quad (form b) x.
Proof.
  unfold all_exceed. rewrite !andb_true_iff, Z.ltb_lt. intros [[_ P] H] I.
  apply (every_sound _ _ H) in I. rewrite !andb_true_iff, Nat.eqb_eq, Z.leb_le in I.
  destruct I as [[[E L] M] Lo]. split; [unfold exceeds in E; apply andb_true_iff in E; apply E |].
  repeat split; auto; [apply (IZR_le 0), Lo |]. intro x. pose proof (exceeds_sound n _ x E). pose
    proof (norm2_nonnegative n x).
  apply (IZR_lt 0) in P. apply Rmult_le_reg_l with (IZR factor); [exact P | lra].
Qed.

Lemma all_exceed_sound n nodes x : all_exceed n nodes = true ->
  norm2 n x <= IZR factor * largest (map form nodes) x.
Proof.
  unfold all_exceed. rewrite !andb_true_iff. intros [[N P] H].
  destruct nodes as [| b nodes]; [discriminate |].
  pose proof (every_sound _ _ H b ltac:(left; reflexivity)) as E. cbv beta in E.
  rewrite !andb_true_iff in E. destruct E as [[[E _] _] _]. apply Z.ltb_lt, (IZR_lt 0) in P.
  apply Rle_trans with (1 := exceeds_sound n _ x E). apply Rmult_le_compat_l; [lra |].
  apply Rmax_l.
Qed.

(* Every mode falls from some node to all nodes of its target. *)
Definition from_source (nodes : list node) (modes : list mode) (sources : list nat)
    (check : sym -> mode -> bool) : bool :=
  (length modes =? length sources)%nat
  && every (fun '(m, a) => match nth_error nodes a with
                             | Some s => check (form s) m | None => false end)
       (combine modes sources).

Lemma from_source_sound nodes modes sources check m : In m modes ->
  from_source nodes modes sources check = true ->
  exists s, In s nodes /\ check (form s) m = true.
Proof.
  unfold from_source. rewrite andb_true_iff, Nat.eqb_eq. intros I [L H].
  revert sources L H. induction modes as [| m0 modes IH]; [destruct I |].
  intros [| a sources] L H; [discriminate |]. simpl in *.
  destruct (nth_error nodes a) as [s |] eqn:E; [| discriminate].
  destruct (check (form s) m0) eqn:H0; [| discriminate]. destruct I as [-> | I].
  - exists s. split; [exact (nth_error_In _ _ E) | exact H0].
  - apply (IH I sources); [lia | exact H].
Qed.

(** *** Contact that is kept, or a loop without any *)

Section Kept.
Variables (n : nat) (modes : list mode) (nodes : list node) (sources : list nat).

Definition step (x y : vec) : Prop :=
  exists e v b, average n modes x e v b
  /\ (forall i, (i < rounded)%nat -> Rabs (e i) <= Rabs (b i))
  /\ forall k, (k < n)%nat -> y k = v k.

Definition kept : bool :=
  is_slow && all_exceed n nodes
  && from_source nodes modes sources
       (fun F m => every (fun b => falls p q n m (errors b) F (form b) (columns m)) nodes).

Theorem kept_sound : kept = true ->
  decays step (largest (map form nodes)) (norm2 n) rho (IZR factor).
Proof.
  unfold kept. rewrite !andb_true_iff. intros [[S N] H]. destruct (slow S) as [S0 Q].
  apply decays_from_step; [exact S0 | | intro x; exact (all_exceed_sound n nodes x N)].
  intros x y (e & v & b & A & E & Y).
  rewrite <- Rsqr_pow2. unfold Rsqr. set (top := rho * rho * largest (map form nodes) x).
  apply largest_below; [apply Rmult_le_pos; [nra | apply largest_nonnegative] |].
  intros G K. apply in_map_iff in K. destruct K as (t & <- & It).
  destruct (all_exceed_each _ _ _ N It) as (Sh & L & P & Lo & Pos).
  rewrite (quad_ext_below n _ _ _ Sh Y).
  assert (B : quad (form t) v <= top + dot (errors t) (fun i => squared e i - squared b i)).
  { apply (average_below n modes x e (errors t) top (quad (form t)) v b); auto.
    - intros. apply quad_convex; assumption.
    - intros m I. destruct (from_source_sound _ _ _ _ _ I H) as (s & Is & C).
      apply (every_sound _ _ C) in It.
      apply Rle_trans with (1 := falls_sound p q Q _ _ _ _ _ _ x e It).
      apply Rplus_le_compat_r, Rmult_le_compat_l; [nra |]. apply largest_above, in_map, Is. }
  assert (D : dot (errors t) (fun i => squared e i - squared b i) <= 0)
    by (apply known_errors; [exact P | rewrite L; exact E]).
  lra.
Qed.
End Kept.

(** *** Contact that is lost and made again *)

(* The first state is the deflection. While it is positive, a mode in contact is in force, or an
   average of some. While it is not, one of free motion moves the others, and the deflection gets
     no deeper than the motion
   leads from the surface, the first entry of that mode's columns. *)
Section Losable.
Variables (n : nat) (modes free : list mode) (nodes free_nodes : list node)
  (sources free_sources : list nat).

Inductive losable_step (x y : vec) : Prop :=
  | touching e v b : 0 < x 0%nat -> average n modes x e v b ->
      (forall i, (i < rounded)%nat -> Rabs (e i) <= Rabs (b i)) ->
      (forall k, (k < n)%nat -> y k = v k) -> losable_step x y
  | flying e v b : x 0%nat <= 0 -> average (n - 1) free (tail x) e v b ->
      (forall i, (i < rounded)%nat -> Rabs (e i) <= Rabs (b i)) ->
      (forall k, (k < n - 1)%nat -> y (S k) = v (S k)) ->
      y 0%nat <= Rmax 0 (v 0%nat) -> losable_step x y.

Definition conewise (x : vec) : R :=
  if Rlt_dec 0 (x 0%nat) then largest (map form nodes) x
  else largest (map form free_nodes) (tail x).

(* The squares of the states, the deflection where it is positive. *)
Definition conewise_size (x : vec) : R :=
  if Rlt_dec 0 (x 0%nat) then norm2 n x else norm2 (n - 1) (tail x).

Definition row_eq : forall a b : Z * list Z, {a = b} + {a <> b}.
Proof. decide equality; [apply list_eq_dec |]; apply Z.eq_dec. Defined.
Definition is_one_of (F : sym) (others : list node) : bool :=
  existsb (fun b => if list_eq_dec row_eq F (form b) then true else false) others.

Definition at_surface (columns : list (list Z)) : list (list Z) :=
  map (fun c => 0%Z :: tl c) columns.

Definition lands (F : sym) (m : mode) (b : node) : bool :=
  falls p q (n - 1) m (errors b) F (form b) (columns m)
  && (if is_one_of (tl (form b)) free_nodes then true
      else falls p q (n - 1) m (errors b) F (form b) (at_surface (columns m))).

Definition losable : bool :=
  is_slow && (0 <? n)%nat && all_exceed n nodes && all_exceed (n - 1) free_nodes
  && from_source nodes modes sources (fun F m =>
       every (fun b => falls p q n m (errors b) F (form b) (columns m)) nodes
       && every (fun b => falls_lost p q n m (lost b) (errors b) F (form b) (columns m))
            free_nodes)
  && from_source free_nodes free free_sources (fun F m =>
       every (fun b => falls p q (n - 1) m (errors b) F (form b) (map (@tl Z) (columns m)))
         free_nodes
       && every (lands F m) nodes).

Lemma image_surface cols : forall x k,
  image (at_surface cols) x k = match k with O => 0 | S j => image cols x (S j) end.
Proof.
  induction cols as [| c cols IH]; intros x k; simpl; [destruct k; reflexivity |].
  rewrite IH. destruct k; simpl; [ring |]. destruct c; simpl; [destruct k |]; reflexivity.
Qed.

(* A form is convex in the depth. *)
Lemma between F x y z v : (0 <= fst (hd (0%Z, []) F))%Z ->
  (forall k, y (S k) = x (S k)) -> (forall k, z (S k) = x (S k)) ->
  z 0%nat = 0 -> 0 <= x 0%nat <= y 0%nat ->
  quad F y <= v -> quad F z <= v -> quad F x <= v.
Proof.
  destruct F as [| [a r] F]; cbn [hd fst quad]; intros P Y Z Z0 [D0 D1]; [tauto |].
  apply (IZR_le 0) in P.
  rewrite (dot_ext r (tail y) (tail x)), (quad_ext F (tail y) (tail x)) by (intro; apply Y).
  rewrite (dot_ext r (tail z) (tail x)), (quad_ext F (tail z) (tail x)) by (intro; apply Z).
  rewrite Z0. set (d := x 0%nat) in *. set (D := y 0%nat) in *.
  set (s := dot r (tail x)). set (c := quad F (tail x)). intros HD H0.
  destruct (Req_dec D 0) as [E | E]; [assert (d = 0) by lra; subst d; nra |].
  apply Rmult_le_reg_l with D; [lra |].
  assert (0 <= IZR a * (d * D * (D - d))).
  { apply Rmult_le_pos; [exact P |]. apply Rmult_le_pos; [apply Rmult_le_pos |]; lra. }
  assert (d * (IZR a * D * D + 2 * D * s + c) <= d * v) by (apply Rmult_le_compat_l; lra).
  assert ((D - d) * c <= (D - d) * v) by (apply Rmult_le_compat_l; lra).
  replace (D * (IZR a * d * d + 2 * d * s + c))
    with (d * (IZR a * D * D + 2 * D * s + c) + (D - d) * c - IZR a * (d * D * (D - d))) by ring.
  lra.
Qed.

Lemma is_one_of_sound F others : is_one_of F others = true -> In F (map form others).
Proof.
  unfold is_one_of. intro H. apply existsb_exists in H. destruct H as (b & I & H).
  destruct (list_eq_dec row_eq F (form b)) as [-> |]; [apply in_map, I | discriminate].
Qed.

Lemma tail_convex (f : vec -> R) : (forall a v u, 0 <= a <= 1 ->
    f (mix a v u) <= (1 - a) * f v + a * f u) ->
  forall a v u, 0 <= a <= 1 -> f (tail (mix a v u)) <= (1 - a) * f (tail v) + a * f (tail u).
Proof. intros C a v u A. exact (C a (tail v) (tail u) A). Qed.

(* Where the deflection is zero. *)
Definition grounded (v : vec) : vec := fun k => match k with O => 0 | S j => v (S j) end.

Lemma quad_grounded T v : quad T (grounded v) = quad (tl T) (tail v).
Proof.
  destruct T as [| [c r] T]; [reflexivity |]. cbn [quad tl]. change (grounded v 0%nat) with 0.
  change (tail (grounded v)) with (tail v). ring.
Qed.

Theorem losable_sound : losable = true ->
  decays losable_step conewise conewise_size rho (IZR factor).
Proof.
  unfold losable. rewrite !andb_true_iff. intros [[[[[Slow N0] N] M] Touch] Fly].
  destruct (slow Slow) as [S0 Q]. apply Nat.ltb_lt in N0.
  assert (R0 : 0 <= rho * rho) by nra.
  assert (Sound := falls_sound p q Q).
  apply decays_from_step; [exact S0 | |].
  2: { intro x. unfold conewise, conewise_size.
       destruct (Rlt_dec 0 (x 0%nat)); apply all_exceed_sound; assumption. }
  intros x y H. rewrite <- Rsqr_pow2. unfold Rsqr, conewise.
  destruct H as [e v b X A E Y | e v b X A E Y D].
  - destruct (Rlt_dec 0 (x 0%nat)) as [_ |]; [| lra].
    set (top := rho * rho * largest (map form nodes) x).
    assert (Top : 0 <= top) by (apply Rmult_le_pos; [exact R0 | apply largest_nonnegative]).
    assert (Up : forall s, In s nodes -> rho * rho * quad (form s) x <= top)
      by (intros s Is; apply Rmult_le_compat_l; [exact R0 |]; apply largest_above, in_map, Is).
    destruct (Rlt_dec 0 (y 0%nat)) as [Y0 | Y0]; apply largest_below; try exact Top;
      intros G K; apply in_map_iff in K; destruct K as (t & <- & It).
    + destruct (all_exceed_each _ _ _ N It) as (Sh & L & P & Lo & Pos).
      rewrite (quad_ext_below n _ _ _ Sh Y).
      assert (B : quad (form t) v <= top + dot (errors t) (fun i => squared e i - squared b i)).
      { apply (average_below n modes x e (errors t) top (quad (form t)) v b); auto.
        - intros. apply quad_convex; assumption.
        - intros m I. destruct (from_source_sound _ _ _ _ _ I Touch) as (s & Is & C).
          apply andb_true_iff in C. destruct C as [C _]. apply (every_sound _ _ C) in It.
          apply Rle_trans with (1 := Sound _ _ _ _ _ _ x e It).
          apply Rplus_le_compat_r, Up, Is. }
      pose proof (known_errors (errors t) e b P (fun i I => E i ltac:(rewrite <- L; exact I))). lra.
    + destruct (all_exceed_each _ _ _ M It) as (Sh & L & P & Lo & Pos).
      rewrite (quad_ext_below (n - 1) _ _ (tail v) Sh) by (intros k K; apply Y; lia).
      set (f := fun u : vec => quad (form t) (tail u) - 2 * IZR (lost t) * x 0%nat * u 0%nat).
      assert (B : f v <= top + dot (errors t) (fun i => squared e i - squared b i)).
      { apply (average_below n modes x e (errors t) top f v b); auto.
        - intros a w u Ha. unfold f.
          pose proof (tail_convex (quad (form t)) (fun a v u H => quad_convex _ a v u Pos H) a w u
            Ha).
          unfold mix at 2. lra.
        - intros m I. destruct (from_source_sound _ _ _ _ _ I Touch) as (s & Is & C).
          apply andb_true_iff in C. destruct C as [_ C]. apply (every_sound _ _ C) in It.
          apply Rle_trans with (1 := falls_lost_sound p q Q _ _ _ _ _ _ _ x e It).
          apply Rplus_le_compat_r, Up, Is. }
      pose proof (known_errors (errors t) e b P (fun i I => E i ltac:(rewrite <- L; exact I))).
      rewrite (Y 0%nat N0) in Y0.
      assert (0 <= - (IZR (lost t) * x 0%nat * v 0%nat)).
      { rewrite Ropp_mult_distr_r. apply Rmult_le_pos; [apply Rmult_le_pos |]; lra. }
      unfold f in B. lra.
  - destruct (Rlt_dec 0 (x 0%nat)) as [| _]; [lra |].
    set (top := rho * rho * largest (map form free_nodes) (tail x)).
    assert (Top : 0 <= top) by (apply Rmult_le_pos; [exact R0 | apply largest_nonnegative]).
    assert (Up : forall s, In s free_nodes -> rho * rho * quad (form s) (tail x) <= top)
      by (intros s Is; apply Rmult_le_compat_l; [exact R0 |]; apply largest_above, in_map, Is).
    assert (Free : forall t, In t free_nodes -> quad (form t) (tail v) <= top).
    { intros t It. destruct (all_exceed_each _ _ _ M It) as (Sh & L & P & Lo & Pos).
      assert (B : quad (form t) (tail v) <= top + dot (errors t) (fun i => squared e i - squared b
        i)).
      { apply (average_below (n - 1) free (tail x) e (errors t) top (fun u => quad (form t) (tail
        u)) v b);
          auto.
        - apply (tail_convex (quad (form t))). intros. apply quad_convex; assumption.
        - intros m I. destruct (from_source_sound _ _ _ _ _ I Fly) as (s & Is & C).
          apply andb_true_iff in C. destruct C as [C _]. apply (every_sound _ _ C) in It.
          pose proof (Sound _ _ _ _ _ _ (tail x) e It) as K.
          rewrite (quad_ext (form t) _ (tail (after (n - 1) m (tail x) e))) in K
            by (intro; apply image_tail).
          apply Rle_trans with (1 := K). apply Rplus_le_compat_r, Up, Is. }
      pose proof (known_errors (errors t) e b P (fun i I => E i ltac:(rewrite <- L; exact I))).
        lra. }
    destruct (Rlt_dec 0 (y 0%nat)) as [Y0 | Y0]; apply largest_below; try exact Top;
      intros G K; apply in_map_iff in K; destruct K as (t & <- & It).
    + destruct (all_exceed_each _ _ _ N It) as (Sh & L & P & Lo & Pos).
      assert (Known := known_errors (errors t) e b P (fun i I => E i ltac:(rewrite <- L; exact I))).
      assert (Lands : forall m, In m free -> exists s, In s free_nodes /\ lands (form s) m t =
        true).
      { intros m I. destruct (from_source_sound _ _ _ _ _ I Fly) as (s & Is & C).
        apply andb_true_iff in C. destruct C as [_ C]. exists s. split; [exact Is |].
        apply (every_sound _ _ C), It. }
      assert (Deep : quad (form t) v <= top).
      { enough (B : quad (form t) v <= top + dot (errors t) (fun i => squared e i - squared b i))
        by lra.
        apply (average_below (n - 1) free (tail x) e (errors t) top (quad (form t)) v b); auto.
        - intros. apply quad_convex; assumption.
        - intros m I. destruct (Lands m I) as (s & Is & C). unfold lands in C.
          rewrite !andb_true_iff in C. destruct C as [C _].
          apply Rle_trans with (1 := Sound _ _ _ _ _ _ (tail x) e C).
          apply Rplus_le_compat_r, Up, Is. }
      assert (Ground : quad (form t) (grounded v) <= top).
      { destruct (is_one_of (tl (form t)) free_nodes) eqn:One.
        { rewrite quad_grounded. apply is_one_of_sound, in_map_iff in One.
          destruct One as (r & <- & Ir). apply Free, Ir. }
        enough (B : quad (form t) (grounded v)
                    <= top + dot (errors t) (fun i => squared e i - squared b i)) by lra.
        apply (average_below (n - 1) free (tail x) e (errors t) top
                 (fun u => quad (form t) (grounded u)) v b); auto.
        - intros a w u Ha. pose proof (quad_convex (form t) a (grounded w) (grounded u) Pos Ha) as
          C.
          rewrite (quad_ext (form t) (grounded (mix a w u)) (mix a (grounded w) (grounded u)));
            [exact C |]. intros [| k]; unfold mix, grounded; ring.
        - intros m I. destruct (Lands m I) as (s & Is & C). unfold lands in C.
          rewrite One, andb_true_iff in C. destruct C as [_ C].
          pose proof (Sound _ _ _ _ _ _ (tail x) e C) as K.
          rewrite (quad_ext _ _ (grounded (after (n - 1) m (tail x) e))) in K
            by (intro k; rewrite image_surface; destruct k; reflexivity).
          apply Rle_trans with (1 := K). apply Rplus_le_compat_r, Up, Is. }
      set (y' := fun k => match k with O => y 0%nat | S j => v (S j) end).
      rewrite (quad_ext_below n _ y y' Sh) by (intros [| k] K; [reflexivity | apply Y; lia]).
      assert (Sign : (0 <= fst (hd (0%Z, []) (form t)))%Z).
      { specialize (Pos (fun k => match k with O => 1 | S _ => 0 end)).
        destruct (form t) as [| [c r] T]; simpl in *; [lia |]. apply le_IZR.
        rewrite quad_zero, dot_zero in Pos by reflexivity. lra. }
      apply (between (form t) y' v (grounded v) top Sign); try reflexivity; try assumption.
      unfold y'. split; [lra |]. destruct (Rle_dec 0 (v 0%nat)).
      * rewrite Rmax_right in D; assumption.
      * rewrite Rmax_left in D; lra.
    + destruct (all_exceed_each _ _ _ M It) as (Sh & _).
      rewrite (quad_ext_below (n - 1) _ _ (tail v) Sh) by (intros k K; apply Y; lia).
      apply Free, It.
Qed.
End Losable.
End Loop.
