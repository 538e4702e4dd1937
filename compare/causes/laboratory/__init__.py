"""What the experiments on one divergence share."""
