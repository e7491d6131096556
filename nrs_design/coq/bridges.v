(** ** A stay of a known length: a form that depends on time leads from one form to another *)

(* The matrix of a polynomial of degree two, times two; checked where it is used. *)
Definition coefficient (P : poly) (m : mono) : Z :=
  fold_right (fun '(c, k) s => if list_eq_dec Nat.eq_dec k m then (c + s)%Z else s) 0%Z P.
Definition matrix_of (n : nat) (P : poly) : sym :=
  map (fun i => ((2 * coefficient P [i; i])%Z,
                 map (fun j => coefficient P [i; j]) (seq (S i) (n - S i)))) (seq 0 n).
Definition nowhere_negative (n : nat) (P : poly) : bool :=
  let T := matrix_of n P in
  vanishes (pscale 2 P ++ pscale (-1) (expanded T (singles n)))
  && (if positive T then true else nonnegative T).

Lemma nowhere_negative_sound n P x : nowhere_negative n P = true -> 0 <= peval P x.
Proof.
  unfold nowhere_negative. cbv zeta. rewrite andb_true_iff. intros [E N].
  apply (vanishes_sound _ x) in E. rewrite peval_app, !peval_scale, peval_expanded in E.
  assert (0 <= quad (matrix_of n P) (monomials (singles n) x)).
  { destruct (positive (matrix_of n P)) eqn:Q; [apply positive_sound, Q |].
    apply nonnegative_sound, N. }
  lra.
Qed.

(* Polynomials in the states as coefficients of one in s. *)
Fixpoint series (cs : list poly) (s : R) (x : vec) : R :=
  match cs with [] => 0 | c :: cs' => peval c x + s * series cs' s x end.
Fixpoint both (a b : list poly) : list poly :=
  match a, b with [], _ => b | _, [] => a | c :: a', d :: b' => (c ++ d) :: both a' b' end.
Fixpoint derivative (cs : list poly) : list poly :=
  match cs with [] => [] | _ :: cs' => both cs' ([] :: derivative cs') end.

Lemma series_both a : forall b s x, series (both a b) s x = series a s x + series b s x.
Proof.
  induction a as [| c a IH]; intros [| d b] s x; simpl; try ring. rewrite IH, peval_app. ring.
Qed.

Fixpoint sums_nowhere_negative (n : nat) (sum : poly) (cs : list poly) : bool :=
  match cs with
  | [] => true
  | c :: cs' =>
      let next := collected (sum ++ c) in
      if nowhere_negative n next then sums_nowhere_negative n next cs' else false
  end.

(* For s from zero to one, it is enough that all sums of the first coefficients are. *)
Lemma sums_sound n s x : 0 <= s <= 1 -> forall cs sum, 0 <= peval sum x ->
  sums_nowhere_negative n sum cs = true -> 0 <= peval sum x + s * series cs s x.
Proof.
  intro S. induction cs as [| c cs IH]; intros sum P H; simpl in *; [nra |].
  destruct (nowhere_negative n (collected (sum ++ c))) eqn:N; [| discriminate].
  apply (nowhere_negative_sound _ _ x) in N. specialize (IH _ N H).
  rewrite peval_collected, peval_app in IH, N.
  replace (peval sum x + s * (peval c x + s * series cs s x))
    with ((1 - s) * peval sum x + s * (peval sum x + peval c x + s * series cs s x)) by ring.
  apply Rplus_le_le_0_compat; apply Rmult_le_pos; lra.
Qed.

Section Bridge.
(* A piece takes a time of hn / hd. *)
Variables (n : nat) (p q hn hd : Z) (f : flow).
Notation rate := (IZR p / IZR q).
Notation h := (IZR hn / IZR hd).

(* Derivative and twice the rate of decay, times hn over q. *)
Definition lie (P : poly) : poly :=
  collected (pscale (hn * q) (along (rows f) P) ++ pscale (2 * p * hn * over f) P).

(* Backward in time from P, where s counts from one down to zero: coefficients that nearly solve the
   equation of the form, with a little more. *)
Fixpoint taylor (count : nat) (i : Z) (P : poly) : list poly :=
  match count with
  | O => []
  | S c =>
      let Q := map (fun '(k, m) => ((k / (hd * over f * q * i))%Z, m)) (lie P) in
      Q :: taylor c (i + 1) Q
  end.
Definition piece (count : nat) (more : Z) (P : poly) : list poly :=
  P :: both [map (fun k => (more, [k; k])) (seq 0 n)] (taylor count 1 P).

Definition piece_falls (cs : list poly) : bool :=
  forallb (within n) cs
  && sums_nowhere_negative n []
       (both (map (pscale (hd * over f * q)) (derivative cs)) (map (fun c => pscale (-1) (lie c))
         cs)).

Fixpoint pieces (number count : nat) (more : Z) (P : poly) : option poly :=
  match number with
  | O => Some P
  | S k =>
      let cs := piece count more P in
      if piece_falls cs then pieces k count more (collected (concat cs)) else None
  end.

Hypotheses (over_positive : (0 < over f)%Z) (q_positive : (0 < q)%Z)
  (hn_positive : (0 < hn)%Z) (hd_positive : (0 < hd)%Z).

Lemma h_positive : 0 < h.
Proof. apply Rdiv_lt_0_compat; apply (IZR_lt 0); assumption. Qed.

Lemma series_one cs x : series cs 1 x = peval (concat cs) x.
Proof. induction cs as [| c cs IH]; simpl; [reflexivity |]. rewrite peval_app, IH. ring. Qed.

Lemma series_scale c cs s x : series (map (pscale c) cs) s x = IZR c * series cs s x.
Proof. induction cs as [| d cs IH]; simpl; [ring |]. rewrite IH, peval_scale. ring. Qed.

Fixpoint series_slope (cs : list poly) (s : R) (x v : vec) : R :=
  match cs with [] => 0 | c :: cs' => slope c x v + s * series_slope cs' s x v end.

Lemma series_lie cs s x :
  series (map (fun c => pscale (-1) (lie c)) cs) s x
  = - (IZR hn * IZR q * IZR (over f) * series_slope cs s x (field f x)
       + 2 * IZR p * IZR hn * IZR (over f) * series cs s x).
Proof.
  apply (IZR_lt 0) in over_positive.
  induction cs as [| c cs IH]; simpl; [ring |].
  rewrite IH, peval_scale. unfold lie. rewrite peval_collected, peval_app, !peval_scale,
    peval_along.
  unfold field at 2. rewrite slope_times, !mult_IZR. field. lra.
Qed.

(* Along a solution, with s = (end - time) / h. *)
Lemma right_series cs (w : R -> vec) v t last :
  (forall c, In c cs -> forall k m, In (k, m) c -> forall i, In i m ->
     right (fun r => w r i) (v i) t) ->
  right (fun r => series cs ((last - r) / h) (w r))
    (series_slope cs ((last - t) / h) (w t) v
     - / h * series (derivative cs) ((last - t) / h) (w t)) t.
Proof.
  pose proof h_positive as H0. induction cs as [| c cs IH]; intro H; simpl.
  - replace (0 - / h * 0) with 0 by ring. apply right_const.
  - rewrite series_both. simpl.
    replace (slope c (w t) v + (last - t) / h * series_slope cs ((last - t) / h) (w t) v
        - / h * (series cs ((last - t) / h) (w t)
                 + (0 + (last - t) / h * series (derivative cs) ((last - t) / h) (w t))))
      with (slope c (w t) v
        + (- / h * series cs ((last - t) / h) (w t) + (last - t) / h
           * (series_slope cs ((last - t) / h) (w t) v
              - / h * series (derivative cs) ((last - t) / h) (w t)))) by ring.
    apply (right_add (fun r => peval c (w r)) (fun r => (last - r) / h * series cs ((last - r) /
      h) (w r))).
    + apply right_peval. intros k m J i I. exact (H c (or_introl eq_refl) k m J i I).
    + apply (right_times (fun r => (last - r) / h) (fun r => series cs ((last - r) / h) (w r))).
      * apply right_derivative.
        pose proof (derivable_pt_lim_mult (fun r => last - r) (fun _ => / h) t (0 - 1) 0
          (derivable_pt_lim_minus (fct_cte last) id t 0 1 (derivable_pt_lim_const last t)
             (derivable_pt_lim_id t)) (derivable_pt_lim_const (/ h) t)) as D.
        replace (- / h) with ((0 - 1) * / h + (last - t) * 0) by ring. exact D.
      * apply IH. intros d I. apply H. right. exact I.
Qed.

Lemma continuous_series cs (w : R -> vec) t last :
  (forall c, In c cs -> forall k m, In (k, m) c -> forall i, In i m ->
     continuity_pt (fun r => w r i) t) ->
  continuity_pt (fun r => series cs ((last - r) / h) (w r)) t.
Proof.
  induction cs as [| c cs IH]; intro H; simpl;
    [apply continuity_pt_const; intros ? ?; reflexivity |].
  apply (continuity_pt_plus (fun r => peval c (w r))).
  - apply continuous_peval. intros k m J i I. exact (H c (or_introl eq_refl) k m J i I).
  - apply (continuity_pt_mult (fun r => (last - r) / h) (fun r => series cs ((last - r) / h) (w
    r))).
    + unfold Rdiv. apply (continuity_pt_mult (fun r => last - r) (fun _ => / h));
        [| apply continuity_pt_const; intros ? ?; reflexivity].
      apply (continuity_pt_minus (fun _ => last) (fun r => r));
        [apply continuity_pt_const; intros ? ?; reflexivity |].
      apply derivable_continuous_pt, derivable_pt_id.
    + apply IH. intros d I. apply H. right. exact I.
Qed.

(* y is in force of f from the time a on, for the time of a piece. *)
Definition flows_for (y : R -> vec) (a time : R) : Prop :=
  (forall k t, (k < n)%nat -> a < t <= a + time -> continuity_pt (fun s => y s k) t)
  /\ (forall k t, (k < n)%nat -> a <= t < a + time -> right (fun s => y s k) (field f (y t) k) t).

Lemma right_shift g v a t : right g v (a + t) -> right (fun s => g (a + s)) v t.
Proof.
  intro H. apply right_iff. intros e E. destruct (proj1 (right_iff _ _ _) H e E) as (d & D & K).
  exists d. split; [exact D |]. intros s S. specialize (K (a + s) ltac:(lra)).
  replace (a + s - (a + t)) with (s - t) in K by ring. exact K.
Qed.

Lemma continuous_shift g a t : continuity_pt g (a + t) -> continuity_pt (fun s => g (a + s)) t.
Proof.
  intro H. apply (continuity_pt_comp (fun s => a + s) g); [| exact H].
  apply (continuity_pt_plus (fun _ => a) (fun r => r));
    [apply continuity_pt_const; intros ? ?; reflexivity |].
  apply derivable_continuous_pt, derivable_pt_id.
Qed.

Lemma share_left a t last : 0 < last -> 0 <= t < last -> 0 <= (a + last - (a + t)) / last <= 1.
Proof.
  intros L T. split.
  - apply Rmult_le_pos; [lra | left; apply Rinv_0_lt_compat; exact L].
  - apply Rmult_le_reg_r with last; [exact L |].
    replace ((a + last - (a + t)) / last * last) with (last - t) by (field; lra). lra.
Qed.

Lemma share_at_end a last : 0 < last -> (a + last - (a + last)) / last = 0.
Proof. intro. field. lra. Qed.

Lemma share_at_begin a last : 0 < last -> (a + last - (a + 0)) / last = 1.
Proof. intro. field. lra. Qed.

Lemma piece_sound cs y a : piece_falls cs = true -> flows_for y a h ->
  series cs 0 (y (a + h)) <= exp (- (2 * rate) * h) * series cs 1 (y a).
Proof.
  unfold piece_falls. rewrite andb_true_iff. intros [W Sums] [C D].
  pose proof h_positive as H0.
  assert (In_n : forall c, In c cs -> forall k m, In (k, m) c -> forall i, In i m -> (i < n)%nat).
  { intros c I. apply within_sound, (proj1 (forallb_forall _ _) W), I. }
  pose proof (falls_exponentially
    (fun t => series cs ((a + h - (a + t)) / h) (y (a + t))) (2 * rate) h) as K.
  cbv beta in K. rewrite (share_at_end a h H0), (share_at_begin a h H0), Rplus_0_r in K. apply K;
    [lra | |].
  - intros t T.
    exists (series_slope cs ((a + h - (a + t)) / h) (y (a + t)) (field f (y (a + t)))
            - / h * series (derivative cs) ((a + h - (a + t)) / h) (y (a + t))).
    split.
    + apply (right_shift (fun r => series cs ((a + h - r) / h) (y r))). apply right_series.
      intros c I k m J i Im. apply D; [exact (In_n c I k m J i Im) | lra].
    + set (s := (a + h - (a + t)) / h). set (x := y (a + t)).
      assert (S : 0 <= s <= 1).
      { apply share_left; lra. }
      match type of Sums with sums_nowhere_negative _ _ ?rs = true =>
        assert (P : 0 <= series rs s x) end.
      { destruct (both _ _) as [| r rs] in *; [simpl; lra |]. simpl in Sums |- *.
        destruct (nowhere_negative n (collected r)) eqn:N; [| discriminate].
        apply (nowhere_negative_sound _ _ x) in N.
        pose proof (sums_sound n s x S rs (collected r) N Sums) as Q.
        rewrite peval_collected in Q. exact Q. }
      rewrite series_both, series_scale, series_lie, !mult_IZR in P.
      set (A := series_slope cs s x (field f x)) in *. set (B := series (derivative cs) s x) in *.
      set (U := series cs s x) in *.
      pose proof (IZR_lt 0 _ over_positive) as o. pose proof (IZR_lt 0 _ q_positive) as q0.
      pose proof (IZR_lt 0 _ hn_positive) as n0. pose proof (IZR_lt 0 _ hd_positive) as d0.
      apply Rmult_le_reg_l with (IZR hn * IZR (over f) * IZR q);
        [repeat apply Rmult_lt_0_compat; assumption |].
      replace (IZR hn * IZR (over f) * IZR q * (A - / h * B))
        with (IZR hn * IZR (over f) * IZR q * A - IZR hd * IZR (over f) * IZR q * B) by (field;
          lra).
      replace (IZR hn * IZR (over f) * IZR q * (- (2 * rate) * U))
        with (- (2 * IZR p * IZR hn * IZR (over f) * U)) by (field; lra).
      lra.
  - intros t T. apply (continuous_shift (fun r => series cs ((a + h - r) / h) (y r))).
    apply continuous_series. intros c I k m J i Im.
    apply C; [exact (In_n c I k m J i Im) | lra].
Qed.

Lemma pieces_sound number count more : forall P P0 y a,
  pieces number count more P = Some P0 -> flows_for y a (INR number * h) ->
  peval P (y (a + INR number * h)) <= exp (- (2 * rate) * (INR number * h)) * peval P0 (y a).
Proof.
  pose proof h_positive as H0.
  induction number as [| k IH]; intros P P0 y a E F.
  - simpl in *. injection E as <-. rewrite Rmult_0_l, Rmult_0_r, Rplus_0_r, exp_0. lra.
  - cbn [pieces] in E. destruct (piece_falls (piece count more P)) eqn:Pf; [| discriminate].
    rewrite S_INR in *. set (N := INR k) in *. assert (N0 : 0 <= N) by apply pos_INR.
    destruct F as [C D].
    assert (First : flows_for y a (N * h)).
    { split; intros j t J T; [apply C | apply D]; try assumption; nra. }
    assert (Second : flows_for y (a + N * h) h).
    { split; intros j t J T; [apply C | apply D]; try assumption; nra. }
    pose proof (IH _ _ y a E First) as I1. pose proof (piece_sound _ y (a + N * h) Pf Second) as I2.
    rewrite series_one in I2. rewrite peval_collected in I1. simpl series in I2.
    rewrite Rmult_0_l, Rplus_0_r in I2.
    replace (a + (N + 1) * h) with (a + N * h + h) by ring.
    apply Rle_trans with (1 := I2).
    replace (- (2 * rate) * ((N + 1) * h)) with (- (2 * rate) * h + - (2 * rate) * (N * h)) by ring.
    rewrite exp_plus, Rmult_assoc. apply Rmult_le_compat_l; [left; apply exp_pos | exact I1].
Qed.
End Bridge.
