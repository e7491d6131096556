import re

from nrs_design.assurance.standards import NOTHING, standards, support_of

# Clauses as the standards number them: IEC 62304 with its amendment, ISO 14971:2019, and the
# first level of IEC 80601-2-77, whose clause 201.N goes with clause N of IEC 60601-1.
CLAUSES = {
    "IEC 62304:2006": "5.1.4, 5.1.10, 5.2.2, 5.4.2, 5.5.5, 5.8.5, 7.1.2, 7.3.3, 8.1.2",
    "ISO 14971:2019": "4.5, 5.4, 5.5, 7.2, 7.3, 10",
    "IEC 80601-2-77:2019": "201.9, 201.12, 201.13, 201.14",
}


def test_clauses_are_those_that_are_known():
    found = {
        s.name.split(" and ")[0]: ", ".join(c.clause.split()[0] for c in s.row) for s in standards()
    }
    assert found == CLAUSES


def test_nothing_is_claimed_for_the_user():
    rows = [clause for standard in standards() for clause in standard.row]
    assert all(clause.user for clause in rows)
    words = " ".join(clause.can for clause in rows)
    assert not re.search(r"\b(conforms?|complies|compliant with|fulfils?|satisf\w+)\b", words)


def test_only_files_that_are_there_support_a_clause():
    rows = {clause.clause.split()[0]: clause for s in standards() for clause in s.row}
    files = ("x.cert.json", "program/x.c", "hazards.md")
    assert support_of(rows["5.4.2"], "x", files) == "x.cert.json, program/"
    assert support_of(rows["5.4.2"], "x", ("x.cert.json",)) == NOTHING
    assert support_of(rows["7.3.3"], "x", files) == "hazards.md"
    assert support_of(rows["5.5"], "x", files) == NOTHING
