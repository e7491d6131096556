from nrs_design.proof.contact import Contact, Flights


def test_nothing_said_of_contact_asks_for_nothing():
    contact = Contact(())
    assert not contact.required
    assert contact.pulls == ()


def test_free_motion_among_some_of_the_modes():
    flights = Flights(("a", "b"), ("free", "far"))
    assert flights.among(["b", "far", "c"]) == Flights(("b",), ("far",))
