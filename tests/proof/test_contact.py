from nrs_design.proof.contact import Contact


def test_nothing_said_of_contact_asks_for_nothing():
    contact = Contact(())
    assert not contact.required
    assert contact.pulls == ()
