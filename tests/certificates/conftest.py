import pytest

from tests.certificates.test_verify import SPECS, signed


@pytest.fixture(scope="module", params=SPECS)
def pair(request):
    """A certificate as a document, and its spec."""
    return signed(request.param)
