"""Pictures as SVG: scenes, curves, plots, the heat map."""
