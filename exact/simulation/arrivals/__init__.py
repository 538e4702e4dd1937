"""Which meetings are predicted, and kept in order: cells, predictions, the queue of arrivals."""
