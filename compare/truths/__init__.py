"""Published numbers, reproduced: `python -m truebreak.compare.truths` writes docs/truths.md."""
