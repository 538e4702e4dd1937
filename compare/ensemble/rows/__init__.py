"""The rows of a sweep: made by a worker, kept in a store, shown as a table."""
