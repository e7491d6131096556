(** ** Loops in continuous time: what is claimed, and what is checked *)

(* x' = (rows) (x, e) / over, with e what other axes do: the sum of the squares of the i-th e over
   all axes is no larger than that of the i-th of the limits, which are rows over x, over a number
   of their own. *)
Record flow := Flow
  { rows : list (list Z); over : Z; limits : list (list Z); limit_over : Z }.

(* For a mode: a form in the monomials of a basis, and the factor that it has. *)
Record witness := Witness { gram : sym; times_decrease : Z }.

Definition pproduct (P Q : poly) : poly :=
  flat_map (fun '(c, m) => pscale c (map (fun '(d, k) => (d, product m k)) Q)) P.

Lemma peval_product P Q x : peval (pproduct P Q) x = peval P x * peval Q x.
Proof.
  induction P as [| [c m] P IH]; simpl; [ring |]. rewrite peval_app, peval_scale, IH.
  enough (E : peval (map (fun '(d, k) => (d, product m k)) Q) x = meval m x * peval Q x)
    by (rewrite E; ring).
  clear. induction Q as [| [d k] Q IH]; simpl; [ring |]. rewrite IH, meval_product. ring.
Qed.

Section Flows.
(* n states, forms of degree 2 d, a rate of decay of p / q, and multipliers of the limits. *)
Variables (n d : nat) (p q : Z) (basis : list mono) (F : sym) (multipliers : list Z)
  (factor : Z).

Definition V (x : vec) : R := quad F (monomials basis x).
Definition alpha : R := IZR p / IZR q.

Let VP : poly := collected (expanded F basis).

(* The sum of m_i (over^2 e_i^2 - (limit_i)^2). *)
Fixpoint given (k : nat) (ms : list Z) (ls : list (list Z)) (lo : Z) : poly :=
  match ms with
  | [] => []
  | m :: ms' =>
      let l := row_terms 0 (hd [] ls) in
      (m * lo * lo, [k; k])%Z :: pscale (- m) (pproduct l l) ++ given (S k) ms' (tl ls) lo
  end.

Fixpoint has_first (m : mono) : bool :=
  match m with [] => false | O :: _ => true | S _ :: m' => has_first m' end.
Fixpoint no_first (P : poly) : poly :=
  match P with
  | [] => []
  | (c, m) :: P' => if has_first m then no_first P' else (c, m) :: no_first P'
  end.

Definition is_falling (surface : bool) (f : flow) (w : witness) (others : list mono) : bool :=
  let c := times_decrease w in
  let lo := limit_over f in
  let P := pscale (c * q * lo * lo) (along (rows f) VP)
           ++ pscale (2 * Z.of_nat d * p * c * over f * lo * lo) VP
           ++ pscale (- (c * over f * q)) (given n multipliers (limits f) lo)
           ++ pscale (over f * q * lo * lo) (expanded (gram w) others) in
  (0 <? c)%Z && (0 <? over f)%Z && (0 <? lo)%Z
  && vanishes (if surface then no_first P else P)
  && positive (gram w).

Definition limit (f : flow) (z : vec) : vec :=
  fun i => dot (nth i (limits f) []) z / IZR (limit_over f).
Definition field (f : flow) (z : vec) : vec :=
  fun i => / IZR (over f) * dot (nth i (rows f) []) z.

Lemma peval_given ms : forall k ls lo z, (0 < lo)%Z ->
  peval (given k ms ls lo) z
  = IZR lo * IZR lo * dot ms (fun i => z (k + i)%nat * z (k + i)%nat
                           - (dot (nth i ls []) z / IZR lo) * (dot (nth i ls []) z / IZR lo)).
Proof.
  induction ms as [| m ms IH]; intros k ls lo z L; simpl; [ring |].
  rewrite peval_app, peval_scale, peval_product, dot_shift, (IH (S k) (tl ls) lo z L), opp_IZR.
  rewrite !mult_IZR, Nat.add_0_r, (dot_ext (hd [] ls) (fun j => z (0 + j)%nat) z) by reflexivity.
  rewrite (dot_ext ms (tail _) (fun i => z (S k + i)%nat * z (S k + i)%nat
    - (dot (nth i (tl ls) []) z / IZR lo) * (dot (nth i (tl ls) []) z / IZR lo))).
  - apply (IZR_lt 0) in L. replace (nth 0 ls []) with (hd [] ls) by (destruct ls; reflexivity).
    field. lra.
  - intro i. unfold tail. rewrite <- Nat.add_succ_comm.
    destruct ls as [| l ls]; [destruct i |]; reflexivity.
Qed.

Lemma meval_first m z : z 0%nat = 0 -> has_first m = true -> meval m z = 0.
Proof.
  intros Z. induction m as [| [| i] m IH]; simpl; [discriminate | rewrite Z; intros; ring |].
  intro H. rewrite IH; auto. ring.
Qed.

Lemma peval_no_first P z : z 0%nat = 0 -> peval (no_first P) z = peval P z.
Proof.
  intro Z. induction P as [| [c m] P IH]; simpl; [reflexivity |].
  destruct (has_first m) eqn:E; simpl; rewrite IH; [| reflexivity].
  rewrite (meval_first m z Z E). ring.
Qed.

Lemma V_polynomial z : V z = peval VP z.
Proof. unfold V, VP. rewrite peval_collected, peval_expanded. reflexivity. Qed.

(* What the check says of one state of one axis. *)
Lemma falling surface f w others x e : (0 < q)%Z ->
  let z := joined n x e in
  is_falling surface f w others = true -> (surface = true -> z 0%nat = 0) ->
  slope VP z (field f z)
  <= - (2 * INR d * alpha) * V z
     + dot multipliers (fun i => squared (fun j => z (n + j)%nat) i - squared (limit f z) i).
Proof.
  intro q_positive. cbn zeta. set (z := joined n x e). unfold is_falling. cbv zeta. rewrite
    !andb_true_iff, !Z.ltb_lt.
  intros [[[[C O] L] E] G] Surface.
  pose proof (positive_sound _ G (monomials others z)) as P.
  match type of E with vanishes (if _ then _ else ?Q) = true => assert (Z : peval Q z = 0) end.
  { destruct surface; [rewrite <- peval_no_first by auto |]; apply vanishes_sound, E. }
  clear E. rewrite !peval_app, !peval_scale, peval_expanded, peval_along, peval_given in Z by
    exact L.
  unfold field. rewrite slope_times. unfold alpha, squared, limit. rewrite V_polynomial.
  rewrite !opp_IZR, !mult_IZR, <- INR_IZR_INZ in Z.
  set (s := slope VP z _) in *. set (v := peval VP z) in *. set (m := dot multipliers _) in *.
  set (g := quad (gram w) _) in *.
  apply (IZR_lt 0) in C, O, L. pose proof (IZR_lt 0 q q_positive) as Q.
  set (c := IZR (times_decrease w)) in *. set (o := IZR (over f)) in *.
  set (l := IZR (limit_over f)) in *.
  assert (Pos : 0 < c * IZR q * l * l * o).
  { repeat apply Rmult_lt_0_compat; assumption. }
  apply Rmult_le_reg_l with (c * IZR q * l * l * o); [exact Pos |].
  replace (c * IZR q * l * l * o * (/ o * s)) with (c * IZR q * l * l * s) by (field; lra).
  replace (c * IZR q * l * l * o * (- (2 * INR d * (IZR p / IZR q)) * v + m))
    with (- (2 * INR d * IZR p * c * o * l * l * v) + c * o * IZR q * (l * l * m)) by (field; lra).
  assert (0 <= o * IZR q * l * l * g) by (repeat apply Rmult_le_pos; lra).
  lra.
Qed.

(** *** Solutions of one axis, and of all *)

(* If contact is lost and made again (cut), the first state is the deflection, and what is seen of
   it is its positive part. *)
Variables (cut : bool) (modes free : list flow).

Definition seen (x : vec) : vec :=
  if cut then fun k => match k with O => Rmax 0 (x 0%nat) | S _ => x k end else x.

Definition for_a_while (P : R -> Prop) (t : R) : Prop :=
  exists h, 0 < h /\ forall s, t <= s < t + h -> P s.

(* Derivatives and limits of the modes, and any average of them. *)
Inductive average (fs : list flow) (z : vec) : vec -> vec -> Prop :=
  | of_one f : In f fs -> average fs z (field f z) (limit f z)
  | of_two a v l u m : 0 <= a <= 1 -> average fs z v l -> average fs z u m ->
      average fs z (fun k => (1 - a) * v k + a * u k) (fun i => (1 - a) * l i + a * m i).

(* At the time t, and for a while after it, the state x is in contact, or free of it. What is in
   force, a mode or an average of some, may change at every time, and with it the derivative from
   the right. *)
Inductive moves (x : R -> vec) (e l : vec) (t : R) : Prop :=
  | touching v : average modes (joined n (x t) e) v l ->
      (cut = true -> for_a_while (fun s => 0 <= x s 0%nat) t) ->
      (forall k, (k < n)%nat -> right (fun s => x s k) (v k) t) -> moves x e l t
  | flying v : average free (joined n (seen (x t)) e) v l ->
      cut = true -> for_a_while (fun s => x s 0%nat <= 0) t ->
      (forall k, (0 < k < n)%nat -> right (fun s => x s k) (v k) t) -> moves x e l t.

Fixpoint total (axes : nat) (f : nat -> R) : R :=
  match axes with O => 0 | S a => total a f + f a end.

(* Any number of axes, up to any time: the sum of V over them falls exponentially. *)
Definition all_axes_decay : Prop :=
  forall (axes : nat) (x : nat -> R -> vec) (e l : nat -> R -> vec) (time : R), 0 <= time ->
  (forall a k t, (a < axes)%nat -> (k < n)%nat -> 0 < t <= time ->
     continuity_pt (fun s => x a s k) t) ->
  (forall a t, (a < axes)%nat -> 0 <= t < time -> moves (x a) (e a t) (l a t) t) ->
  (forall i t, (i < length multipliers)%nat -> 0 <= t < time ->
     total axes (fun a => squared (e a t) i) <= total axes (fun a => squared (l a t) i)) ->
  total axes (fun a => V (seen (x a time)))
  <= exp (- (2 * INR d * alpha) * time) * total axes (fun a => V (seen (x a 0))).

(* One axis on which no other acts. *)
Definition decays : Prop :=
  forall (x : R -> vec) (time : R), 0 <= time ->
  (forall k t, (k < n)%nat -> 0 < t <= time -> continuity_pt (fun s => x s k) t) ->
  (forall t, 0 <= t < time -> exists l, moves x (fun _ => 0) l t) ->
  V (seen (x time)) <= exp (- (2 * INR d * alpha) * time) * V (seen (x 0)).

(* V is no smaller than the squares of all monomials of the basis but for a factor. *)
Definition is_definite : Prop :=
  forall x, norm2 (length basis) (monomials basis x) <= IZR factor * V x.

Variables (others free_others : list mono) (gives free_gives : list witness).

Definition unpushed (f : flow) : flow :=
  Flow ([] :: tl (rows f)) (over f) (limits f) (limit_over f).

Fixpoint all_falling (surface : bool) (fs : list flow) (ws : list witness) (o : list mono) : bool :=
  match fs, ws with
  | [], [] => true
  | f :: fs', w :: ws' =>
      if is_falling surface (if surface then unpushed f else f) w o
      then all_falling surface fs' ws' o else false
  | _, _ => false
  end.

Definition flows_fall : bool :=
  (0 <? p)%Z && (0 <? q)%Z && implb cut (0 <? n)%nat && forallb (Z.leb 0) multipliers
  && forallb (fun '(_, m) => forallb (fun i => (i <? n)%nat) m) VP
  && positive (lowered (length basis) (map (zrow factor) F))
  && all_falling false modes gives others && all_falling true free free_gives free_others.

Lemma all_falling_sound surface f : forall fs ws o, In f fs ->
  all_falling surface fs ws o = true ->
  exists w, is_falling surface (if surface then unpushed f else f) w o = true.
Proof.
  induction fs as [| g fs IH]; intros [| w ws] o I H; simpl in *; try tauto; try discriminate.
  destruct (is_falling surface (if surface then unpushed g else g) w o) eqn:E; [| discriminate].
  destruct I as [-> | I]; [exists w; exact E | exact (IH ws o I H)].
Qed.

Lemma joined_after x e j : joined n x e (n + j)%nat = e j.
Proof.
  unfold joined. rewrite (proj2 (Nat.ltb_ge (n + j) n)) by lia. f_equal. lia.
Qed.

Lemma slope_ext P x v w : (forall c m, In (c, m) P -> forall i, In i m -> v i = w i) ->
  slope P x v = slope P x w.
Proof.
  induction P as [| [c m] P IH]; intro H; simpl; [reflexivity |]. f_equal.
  - f_equal. specialize (H c m (or_introl eq_refl)). induction m as [| i m IHm]; simpl;
    [reflexivity |].
    rewrite (H i), IHm; [reflexivity | | left; reflexivity]. intros j J. apply H. right. exact J.
  - apply IH. intros d' k K. apply (H d' k). right. exact K.
Qed.

Lemma peval_ext P x y : (forall c m, In (c, m) P -> forall i, In i m -> x i = y i) ->
  peval P x = peval P y.
Proof.
  induction P as [| [c m] P IH]; intro H; simpl; [reflexivity |]. f_equal.
  - f_equal. specialize (H c m (or_introl eq_refl)). induction m as [| i m IHm]; simpl;
    [reflexivity |].
    rewrite (H i), IHm; [reflexivity | | left; reflexivity]. intros j J. apply H. right. exact J.
  - apply IH. intros d' k K. apply (H d' k). right. exact K.
Qed.

Section Sound.
Hypothesis holds : flows_fall = true.

Lemma below_n : forall c m, In (c, m) VP -> forall i, In i m -> (i < n)%nat.
Proof.
  unfold flows_fall in holds. rewrite !andb_true_iff in holds.
  destruct holds as [[[[_ B] _] _] _]. intros c m I i J.
  apply (proj1 (forallb_forall _ _) B) in I. simpl in I.
  apply (proj1 (forallb_forall _ _) I) in J. apply Nat.ltb_lt, J.
Qed.

Lemma VP_joined x e : peval VP (joined n x e) = V x.
Proof.
  rewrite V_polynomial. apply peval_ext. intros c m I i J. unfold joined.
  rewrite (proj2 (Nat.ltb_lt i n)); [reflexivity | exact (below_n c m I i J)].
Qed.

Lemma slope_joined x e v : slope VP (joined n x e) v = slope VP x v.
Proof.
  assert (H := below_n). induction VP as [| [c m] P IH]; simpl; [reflexivity |].
  rewrite IH by (intros d' k K; apply (H d' k); right; exact K). f_equal. f_equal.
  specialize (H c m (or_introl eq_refl)). induction m as [| i m IHm]; simpl; [reflexivity |].
  rewrite IHm by (intros j J; apply H; right; exact J). unfold joined at 2.
  rewrite (proj2 (Nat.ltb_lt i n)) by (apply H; left; reflexivity). f_equal. f_equal.
  clear IHm. assert (K : forall j, In j m -> (j < n)%nat) by (intros; apply H; right; assumption).
  clear H. induction m as [| j m IHm]; simpl; [reflexivity |].
  rewrite IHm by (intros; apply K; right; assumption). unfold joined.
  rewrite (proj2 (Nat.ltb_lt j n)) by (apply K; left; reflexivity). reflexivity.
Qed.

(* In free motion, what is seen of the deflection stays at zero. *)
Definition kept_zero (surface : bool) (v : vec) : vec :=
  fun k => match k with O => if surface then 0 else v 0%nat | S _ => v k end.

Lemma average_falls surface fs ws o y e v l :
  (0 < q)%Z -> forallb (Z.leb 0) multipliers = true -> all_falling surface fs ws o = true ->
  let z := joined n y e in (surface = true -> z 0%nat = 0) -> average fs z v l ->
  slope VP z (kept_zero surface v)
  <= - (2 * INR d * alpha) * V z + dot multipliers (fun i => squared e i - squared l i).
Proof.
  intros Q P A z Z H. induction H as [f I | a v l u m Ha _ IHv _ IHu].
  - destruct (all_falling_sound surface f fs ws o I A) as [w W].
    pose proof (falling surface _ w o y e Q W Z) as K. cbv zeta in K. fold z in K.
    rewrite (dot_ext multipliers (fun i => squared e i - squared (limit f z) i)
      (fun i => squared (fun j => z (n + j)%nat) i
                - squared (limit (if surface then unpushed f else f) z) i)).
    + rewrite (slope_ext VP z _ (field (if surface then unpushed f else f) z)); [exact K |].
      intros c m _ i _. destruct surface; destruct i; try reflexivity.
      * unfold kept_zero, field. simpl. ring.
      * unfold kept_zero, field. simpl. do 2 f_equal. destruct (rows f); [destruct i |];
        reflexivity.
    + intro i. unfold squared, z. rewrite joined_after. destruct surface; reflexivity.
  - rewrite (slope_ext VP z _ (fun k => (1 - a) * kept_zero surface v k + a * kept_zero surface u
    k))
      by (intros c k _ i _; destruct i, surface; simpl; ring).
    rewrite slope_mix. pose proof (limits_convex multipliers a Ha P e l m) as C.
    assert ((1 - a) * slope VP z (kept_zero surface v) <= (1 - a)
      * (- (2 * INR d * alpha) * V z + dot multipliers (fun i => squared e i - squared l i)))
      by (apply Rmult_le_compat_l; [lra | exact IHv]).
    assert (a * slope VP z (kept_zero surface u) <= a
      * (- (2 * INR d * alpha) * V z + dot multipliers (fun i => squared e i - squared m i)))
      by (apply Rmult_le_compat_l; [lra | exact IHu]).
    lra.
Qed.

Lemma average_ext fs y z v l : (forall k, y k = z k) -> average fs y v l ->
  exists u m, average fs z u m /\ (forall k, v k = u k) /\ (forall i, l i = m i).
Proof.
  intros E H. induction H as [f I | a v l u m A _ (v' & l' & Hv & Ev & El) _ (u' & m' & Hu & Eu &
    Em)].
  - exists (field f z), (limit f z). split; [constructor; exact I |].
    split; intro k; [unfold field | unfold limit]; rewrite (dot_ext _ y z E); reflexivity.
  - exists (fun k => (1 - a) * v' k + a * u' k), (fun i => (1 - a) * l' i + a * m' i).
    split; [apply of_two; assumption |].
    split; intro k; [rewrite Ev, Eu | rewrite El, Em]; reflexivity.
Qed.

(* One axis at one time. *)
Lemma moves_falls x e l t : moves x e l t ->
  exists v, right (fun s => V (seen (x s))) v t
    /\ v <= - (2 * INR d * alpha) * V (seen (x t))
           + dot multipliers (fun i => squared e i - squared l i).
Proof.
  intro M. pose proof holds as H. unfold flows_fall in H. rewrite !andb_true_iff, !Z.ltb_lt in H.
  destruct H as [[[[[[[_ Q] N] P] _] _] T] Fr].
  assert (Goal : forall surface fs ws o v m,
    all_falling surface fs ws o = true -> average fs (joined n (seen (x t)) e) v m ->
    (surface = true -> joined n (seen (x t)) e 0%nat = 0) -> (forall i, l i = m i) ->
    (forall k, (k < n)%nat -> right (fun s => seen (x s) k) (kept_zero surface v k) t) ->
    exists v, right (fun s => V (seen (x s))) v t
      /\ v <= - (2 * INR d * alpha) * V (seen (x t))
             + dot multipliers (fun i => squared e i - squared l i)).
  { intros surface fs ws o v m Fa A Su L D.
    exists (slope VP (seen (x t)) (kept_zero surface v)). split.
    - apply (right_ext (fun s => peval VP (seen (x s))) _ _ _ 1 Rlt_0_1);
        [intros; symmetry; apply V_polynomial |].
      apply right_peval. intros c k I i J. apply D. exact (below_n c k I i J).
    - pose proof (average_falls surface fs ws o (seen (x t)) e v m Q P Fa Su A) as K. cbv zeta in K.
      rewrite slope_joined, (V_polynomial (joined n (seen (x t)) e)), VP_joined in K.
      rewrite (dot_ext multipliers _ (fun i => squared e i - squared m i)); [exact K |].
      intro i. unfold squared. rewrite L. reflexivity. }
  destruct M as [v A S D | v A C S D].
  - assert (E : forall k, joined n (x t) e k = joined n (seen (x t)) e k).
    { intro k. unfold joined. destruct (k <? n)%nat; [| reflexivity]. unfold seen.
      destruct cut; [| reflexivity]. destruct (S eq_refl) as (h & Hh & B).
      destruct k; [| reflexivity]. symmetry. apply Rmax_right, B. lra. }
    destruct (average_ext _ _ _ _ _ E A) as (u & m & Au & Ev & El).
    apply (Goal false modes gives others u m T Au); [discriminate | exact El |].
    intros k K. replace (kept_zero false u k) with (v k) by (rewrite Ev; destruct k; reflexivity).
    specialize (D k K). unfold seen. destruct cut; [| exact D].
    destruct (S eq_refl) as (h & Hh & B). apply (right_ext (fun s => x s k) _ _ _ h Hh); [| exact
      D].
    intros s Bs. destruct k; [| reflexivity]. symmetry. apply Rmax_right, B, Bs.
  - destruct S as (h & Hh & B).
    assert (Z : forall s, t <= s < t + h -> seen (x s) 0%nat = 0).
    { intros s Bs. unfold seen. rewrite C. apply Rmax_left, B, Bs. }
    apply (Goal true free free_gives free_others v l Fr A); [| reflexivity |].
    + intros _. unfold joined. rewrite C in N. simpl in N. rewrite N. apply Z. lra.
    + intros [| k] K; simpl.
      * apply (right_ext (fun _ => 0) _ _ _ h Hh); [intros; symmetry; apply Z; assumption |].
        apply right_const.
      * apply (right_ext (fun s => x s (S k)) _ _ _ 1 Rlt_0_1); [| apply D; lia].
        intros. unfold seen. rewrite C. reflexivity.
Qed.

Lemma continuous_seen x t : (forall k, (k < n)%nat -> continuity_pt (fun s => x s k) t) ->
  continuity_pt (fun s => V (seen (x s))) t.
Proof.
  intro H. apply (continuous_ext (fun s => peval VP (seen (x s))));
    [intro; symmetry; apply V_polynomial |].
  apply continuous_peval. intros c m I i J. specialize (H i (below_n c m I i J)).
  unfold seen. destruct cut; [| exact H]. destruct i; [| exact H].
  apply (continuous_ext (fun s => / 2 * (x s 0%nat + Rabs (x s 0%nat)))).
  { intro s. unfold Rmax. destruct (Rle_dec 0 (x s 0%nat)).
    - rewrite Rabs_right; lra.
    - rewrite Rabs_left; lra. }
  apply continuity_pt_mult; [apply continuity_pt_const; intros ? ?; reflexivity |].
  apply continuity_pt_plus; [exact H |].
  apply (continuity_pt_comp (fun s => x s 0%nat) Rabs); [exact H | apply Rcontinuity_abs].
Qed.

Lemma total_le axes f g : (forall a, (a < axes)%nat -> f a <= g a) -> total axes f <= total axes g.
Proof.
  induction axes as [| a IH]; intro H; simpl; [lra |].
  apply Rplus_le_compat; [apply IH; intros; apply H; lia | apply H; lia].
Qed.

Lemma total_linear axes c f g :
  total axes (fun a => c * f a + g a) = c * total axes f + total axes g.
Proof. induction axes as [| a IH]; simpl; [ring |]. rewrite IH. ring. Qed.

(* With multipliers that are not negative, what is given of the sums holds with them. *)
Lemma total_given axes ms : forall e l : nat -> vec, forallb (Z.leb 0) ms = true ->
  (forall i, (i < length ms)%nat ->
     total axes (fun a => squared (e a) i) <= total axes (fun a => squared (l a) i)) ->
  total axes (fun a => dot ms (fun i => squared (e a) i - squared (l a) i)) <= 0.
Proof.
  induction ms as [| m ms IH]; intros e l P H; simpl in *.
  - clear. induction axes; simpl; lra.
  - apply andb_true_iff in P. destruct P as [P0 P]. apply Z.leb_le, (IZR_le 0) in P0.
    pose proof (IH (fun a => tail (e a)) (fun a => tail (l a)) P
                  (fun i I => H (S i) ltac:(lia))) as K.
    pose proof (H 0%nat ltac:(lia)) as H0.
    rewrite total_linear.
    assert (E : total axes (fun a => squared (e a) 0%nat - squared (l a) 0%nat)
              = total axes (fun a => squared (e a) 0%nat) - total axes (fun a => squared (l a)
                0%nat)).
    { clear. induction axes as [| a IH]; simpl; [ring |]. rewrite IH. ring. }
    rewrite E. unfold tail, squared in *. nra.
Qed.

Lemma right_total axes (f : nat -> R -> R) c h t :
  (forall a, (a < axes)%nat -> exists v, right (f a) v t /\ v <= c * f a t + h a) ->
  exists v, right (fun s => total axes (fun a => f a s)) v t
    /\ v <= c * total axes (fun a => f a t) + total axes h.
Proof.
  induction axes as [| a IH]; intro H; simpl.
  - exists 0. split; [apply right_const | lra].
  - destruct IH as (v & Dv & B); [intros; apply H; lia |].
    destruct (H a ltac:(lia)) as (w & Dw & C). exists (v + w).
    split; [exact (right_add (fun s => total a (fun b => f b s)) (f a) v w t Dv Dw) | lra].
Qed.

Lemma continuous_total axes (f : nat -> R -> R) t :
  (forall a, (a < axes)%nat -> continuity_pt (f a) t) ->
  continuity_pt (fun s => total axes (fun a => f a s)) t.
Proof.
  induction axes as [| a IH]; intro H; simpl; [apply continuity_pt_const; intros ? ?; reflexivity
    |].
  apply (continuity_pt_plus (fun s => total a (fun b => f b s)) (f a));
    [apply IH; intros; apply H; lia | apply H; lia].
Qed.

Theorem all_axes_sound : all_axes_decay.
Proof.
  intros axes x e l time End C M G.
  apply (falls_exponentially (fun t => total axes (fun a => V (seen (x a t)))) _ _ End).
  - intros t T.
    destruct (right_total axes (fun a s => V (seen (x a s))) (- (2 * INR d * alpha))
      (fun a => dot multipliers (fun i => squared (e a t) i - squared (l a t) i)) t)
      as (v & Dv & B); [intros a A; apply moves_falls, M; assumption |].
    exists v. split; [exact Dv |].
    assert (total axes (fun a => dot multipliers
              (fun i => squared (e a t) i - squared (l a t) i)) <= 0); [| lra].
    apply total_given; [| intros i I; apply G; assumption].
    unfold flows_fall in holds. rewrite !andb_true_iff in holds. apply holds.
  - intros t T. apply continuous_total. intros a A. apply continuous_seen.
    intros k K. apply C; assumption.
Qed.

Theorem decays_sound : multipliers = [] -> decays.
Proof.
  intros N x time End C M.
  apply (falls_exponentially (fun t => V (seen (x t))) _ _ End).
  - intros t T. destruct (M t T) as [l Ml]. destruct (moves_falls x _ l t Ml) as (v & Dv & B).
    exists v. split; [exact Dv |]. rewrite N in B. simpl in B. lra.
  - intros t T. apply continuous_seen. intros k K. apply C; assumption.
Qed.

Theorem definite_sound : is_definite.
Proof.
  unfold flows_fall in holds. rewrite !andb_true_iff in holds.
  destruct holds as [[[_ P] _] _]. intro x.
  pose proof (positive_sound _ P (monomials basis x)) as K.
  rewrite quad_lowered, quad_scale in K. unfold V. lra.
Qed.
End Sound.
End Flows.

(** *** Quadratic forms *)

Definition none : vec := fun _ => 0.

Definition singles (n : nat) : list mono := map (fun k => [k]) (seq 0 n).

Lemma nth_singles n : forall a k, (k < n)%nat ->
  nth_error (map (fun k => [k]) (seq a n)) k = Some [(a + k)%nat].
Proof.
  induction n as [| n IH]; intros a [| k] K; simpl; try lia; [rewrite Nat.add_0_r; reflexivity |].
  rewrite IH by lia. f_equal. f_equal. lia.
Qed.

Lemma V_singles n F x : shaped n F = true -> V (singles n) F x = quad F x.
Proof.
  intro S. apply (quad_ext_below n); [exact S |]. intros k K. unfold monomials, singles.
  rewrite nth_singles by exact K. simpl. ring.
Qed.

(* Whether a polynomial is one of the first n entries. *)
Definition within (n : nat) (P : poly) : bool :=
  forallb (fun '(_, m) => forallb (fun i => (i <? n)%nat) m) P.

Lemma within_sound n P : within n P = true ->
  forall c m, In (c, m) P -> forall i, In i m -> (i < n)%nat.
Proof.
  intros W c m I i J. apply (proj1 (forallb_forall _ _) W) in I. simpl in I.
  apply (proj1 (forallb_forall _ _) I) in J. apply Nat.ltb_lt, J.
Qed.
