from nrs_design.assurance.gsn import GsnElement, GsnKind, goal, render_text, solution


def test_the_outline_shows_support_context_and_what_is_open():
    context = GsnElement("C1", GsnKind.CONTEXT, "a room")
    strategy = GsnElement(
        "S1",
        GsnKind.STRATEGY,
        "by parts",
        (goal("G2", "one", solution("Sn1", "a test")), goal("G3", "two", refuted=True)),
    )
    top = GsnElement("G1", GsnKind.GOAL, "all", (strategy,), (context,))
    assert render_text(top) == (
        "G1 (goal): all\n"
        "    in context of C1 (context): a room\n"
        "  S1 (strategy): by parts\n"
        "    G2 (goal): one\n"
        "      Sn1 (solution): a test\n"
        "    G3 (goal) [undeveloped] [REFUTED]: two\n"
    )


def test_only_goals_and_strategies_need_support():
    assert goal("G1", "x").undeveloped
    assert GsnElement("S1", GsnKind.STRATEGY, "x").undeveloped
    assert not solution("Sn1", "x").undeveloped
    assert not GsnElement("C1", GsnKind.CONTEXT, "x").undeveloped
    assert not goal("G1", "x", solution("Sn1", "y")).undeveloped
