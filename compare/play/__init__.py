"""A page to play with: scenes drawn by hand, run exactly and in doubles, on this computer or in the browser itself."""
