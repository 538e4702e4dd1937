"""`python -m truebreak.floating.flat`: writes `inlined.py`."""

from .formulas.inlining import write

if __name__ == "__main__":
    print(f"wrote {write()}")
