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
Variables p q factor : Z.
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
  negb (match nodes with [] => true | _ => false end) && (0 <=? factor)%Z
  && forallb (fun b => exceeds n (form b)) nodes.

Lemma all_exceed_sound n nodes x : all_exceed n nodes = true ->
  norm2 n x <= IZR factor * largest (map form nodes) x.
Proof.
  unfold all_exceed. rewrite !andb_true_iff. intros [[N P] H].
  destruct nodes as [| b nodes]; [discriminate |]. cbn [forallb map] in *.
  apply andb_true_iff in H. destruct H as [H _]. apply Z.leb_le, (IZR_le 0) in P.
  apply Rle_trans with (1 := exceeds_sound n _ x H). apply Rmult_le_compat_l; [exact P |].
  apply Rmax_l.
Qed.

Lemma all_shaped n nodes b : all_exceed n nodes = true -> In b nodes -> shaped n (form b) = true.
Proof.
  unfold all_exceed. rewrite !andb_true_iff. intros [_ H] I.
  apply (proj1 (forallb_forall _ _) H) in I. unfold exceeds in I. rewrite andb_true_iff in I.
  apply I.
Qed.

(* Every mode falls from some node to all nodes of its target. *)
Definition from_source (nodes : list node) (modes : list mode) (sources : list nat)
    (check : sym -> mode -> bool) : bool :=
  (length modes =? length sources)%nat
  && forallb (fun '(m, a) => match nth_error nodes a with
                             | Some s => check (form s) m | None => false end)
       (combine modes sources).

Lemma from_source_sound nodes modes sources check m : In m modes ->
  from_source nodes modes sources check = true ->
  exists s, In s nodes /\ check (form s) m = true.
Proof.
  unfold from_source. rewrite andb_true_iff, Nat.eqb_eq. intros I [L H].
  revert sources L H. induction modes as [| m0 modes IH]; [destruct I |].
  intros [| a sources] L H; [discriminate |]. simpl in *.
  apply andb_true_iff in H. destruct H as [H0 H]. destruct I as [-> | I].
  - destruct (nth_error nodes a) as [s |] eqn:E; [| discriminate].
    exists s. split; [exact (nth_error_In _ _ E) | exact H0].
  - apply (IH I sources); [lia | exact H].
Qed.

(** *** Contact that is kept, or a loop without any *)

Section Kept.
Variables (n : nat) (modes : list mode) (nodes : list node) (sources : list nat).

Definition step (x y : vec) : Prop :=
  exists m e, In m modes /\ allowed n m x e /\ forall k, (k < n)%nat -> y k = after n m x e k.

Definition kept : bool :=
  is_slow && all_exceed n nodes
  && from_source nodes modes sources
       (fun F m => forallb (fun b => falls p q n m (errors b) F (form b) (columns m)) nodes).

Theorem kept_sound : kept = true ->
  decays step (largest (map form nodes)) (norm2 n) rho (IZR factor).
Proof.
  unfold kept. rewrite !andb_true_iff. intros [[S N] H]. destruct (slow S) as [S0 Q].
  apply decays_from_step; [exact S0 | | intro x; exact (all_exceed_sound n nodes x N)].
  intros x y (m & e & I & A & E). destruct (from_source_sound _ _ _ _ _ I H) as (s & Is & C).
  rewrite <- Rsqr_pow2. unfold Rsqr.
  apply largest_below.
  - apply Rmult_le_pos; [nra | apply largest_nonnegative].
  - intros G K. apply in_map_iff in K. destruct K as (b & <- & Ib).
    rewrite (quad_ext_below n _ _ _ (all_shaped _ _ _ N Ib) E).
    apply (proj1 (forallb_forall _ _) C) in Ib.
    apply Rle_trans with (1 := falls_sound p q Q _ _ _ _ _ _ x e Ib A).
    apply Rmult_le_compat_l; [nra |]. apply largest_above, in_map, Is.
Qed.
End Kept.

(** *** Contact that is lost and made again *)

(* The first state is the deflection. While it is positive, a mode in contact is in force. While it
   is not, a mode of free motion moves the others, and the deflection gets no deeper than the motion
   leads from the surface, the first entry of that mode's columns. *)
Section Losable.
Variables (n : nat) (modes free : list mode) (nodes free_nodes : list node)
  (sources free_sources : list nat).

Inductive losable_step (x y : vec) : Prop :=
  | touching m e : 0 < x 0%nat -> In m modes -> allowed n m x e ->
      (forall k, (k < n)%nat -> y k = after n m x e k) -> losable_step x y
  | flying m e : x 0%nat <= 0 -> In m free -> allowed (n - 1) m (tail x) e ->
      (forall k, (k < n - 1)%nat -> y (S k) = after (n - 1) m (tail x) e (S k)) ->
      y 0%nat <= Rmax 0 (after (n - 1) m (tail x) e 0%nat) -> losable_step x y.

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
  (0 <=? fst (hd (0%Z, []) (form b)))%Z
  && falls p q (n - 1) m (errors b) F (form b) (columns m)
  && (is_one_of (tl (form b)) free_nodes
      || falls p q (n - 1) m (errors b) F (form b) (at_surface (columns m))).

Definition losable : bool :=
  is_slow && (0 <? n)%nat && all_exceed n nodes && all_exceed (n - 1) free_nodes
  && from_source nodes modes sources (fun F m =>
       forallb (fun b => falls p q n m (errors b) F (form b) (columns m)) nodes
       && forallb (fun b => falls_lost p q n m (lost b) (errors b) F (form b) (columns m))
            free_nodes)
  && from_source free_nodes free free_sources (fun F m =>
       forallb (fun b => falls p q (n - 1) m (errors b) F (form b) (map (@tl Z) (columns m)))
         free_nodes
       && forallb (lands F m) nodes).

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
  destruct H as [m e X I A E | m e X I A E D].
  - destruct (Rlt_dec 0 (x 0%nat)) as [_ |]; [| lra].
    destruct (from_source_sound _ _ _ _ _ I Touch) as (s & Is & C).
    apply andb_true_iff in C. destruct C as [C L].
    assert (V : rho * rho * quad (form s) x <= rho * rho * largest (map form nodes) x)
      by (apply Rmult_le_compat_l; [exact R0 |]; apply largest_above, in_map, Is).
    assert (V0 : 0 <= rho * rho * largest (map form nodes) x)
      by (apply Rmult_le_pos; [exact R0 | apply largest_nonnegative]).
    destruct (Rlt_dec 0 (y 0%nat)) as [Y | Y]; apply largest_below; try exact V0;
      intros G K; apply in_map_iff in K; destruct K as (b & <- & Ib).
    + rewrite (quad_ext_below n _ _ _ (all_shaped _ _ _ N Ib) E).
      apply (proj1 (forallb_forall _ _) C) in Ib.
      apply Rle_trans with (1 := Sound _ _ _ _ _ _ x e Ib A). exact V.
    + rewrite (quad_ext_below (n - 1) _ _ (tail (after n m x e)) (all_shaped _ _ _ M Ib))
        by (intros k K; apply E; lia).
      apply (proj1 (forallb_forall _ _) L) in Ib.
      apply Rle_trans with (2 := V).
      apply (falls_lost_sound p q Q _ _ _ _ _ _ _ x e Ib A); [lra |].
      rewrite (E 0%nat N0) in Y. unfold after in Y. lra.
  - destruct (Rlt_dec 0 (x 0%nat)) as [| _]; [lra |].
    destruct (from_source_sound _ _ _ _ _ I Fly) as (s & Is & C).
    apply andb_true_iff in C. destruct C as [C L].
    set (v := rho * rho * largest (map form free_nodes) (tail x)).
    assert (V : rho * rho * quad (form s) (tail x) <= v)
      by (apply Rmult_le_compat_l; [exact R0 |]; apply largest_above, in_map, Is).
    assert (V0 : 0 <= v) by (apply Rmult_le_pos; [exact R0 | apply largest_nonnegative]).
    set (f := after (n - 1) m (tail x) e) in *.
    assert (Free : forall G, In G (map form free_nodes) -> quad G (tail f) <= v).
    { intros G K. apply in_map_iff in K. destruct K as (b & <- & Ib).
      rewrite (quad_ext (form b) _ (image (map (@tl Z) (columns m)) (zeta (n - 1) m (tail x) e)))
        by (intro k; symmetry; apply image_tail).
      apply (proj1 (forallb_forall _ _) C) in Ib.
      apply Rle_trans with (1 := Sound _ _ _ _ _ _ (tail x) e Ib A). exact V. }
    destruct (Rlt_dec 0 (y 0%nat)) as [Y | Y]; apply largest_below; try exact V0;
      intros G K; apply in_map_iff in K; destruct K as (b & <- & Ib).
    + pose proof (all_shaped _ _ _ N Ib) as Sh.
      apply (proj1 (forallb_forall _ _) L) in Ib. unfold lands in Ib.
      rewrite !andb_true_iff in Ib. destruct Ib as [[P Deep] Surface]. apply Z.leb_le in P.
      set (y' := fun k => match k with O => y 0%nat | S j => f (S j) end).
      rewrite (quad_ext_below n _ y y' Sh)
        by (intros [| k] K; [reflexivity | apply E; lia]).
      set (z := fun k => match k with O => 0 | S j => f (S j) end).
      apply (between (form b) y' f z v P); try reflexivity.
      * unfold y'. split; [lra |]. destruct (Rle_dec 0 (f 0%nat)).
        -- rewrite Rmax_right in D; assumption.
        -- rewrite Rmax_left in D; lra.
      * apply Rle_trans with (1 := Sound _ _ _ _ _ _ (tail x) e Deep A). exact V.
      * apply orb_true_iff in Surface. destruct Surface as [One | Falls].
        -- apply is_one_of_sound, Free in One.
           destruct (form b) as [| [a r] T]; cbn [quad tl] in *; [lra |].
           change (z 0%nat) with 0. change (tail z) with (tail f). lra.
        -- rewrite (quad_ext _ z (image (at_surface (columns m)) (zeta (n - 1) m (tail x) e)))
             by (intro k; rewrite image_surface; destruct k; reflexivity).
           apply Rle_trans with (1 := Sound _ _ _ _ _ _ (tail x) e Falls A). exact V.
    + rewrite (quad_ext_below (n - 1) _ _ (tail f) (all_shaped _ _ _ M Ib))
        by (intros k K; apply E; lia).
      apply Free, in_map, Ib.
Qed.
End Losable.
End Loop.
