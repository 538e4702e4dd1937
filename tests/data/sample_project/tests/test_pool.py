"""The tests of the sample project."""

from pool import Mended, Pool

import compare
import scenarios


def test_mended(truebreak):
    assert compare.WHOSE == "the sample's"
    truebreak.check(Mended(), scenarios.TABLE)


def test_with_a_bug(truebreak):
    truebreak.check(Pool(), scenarios.TABLE)
