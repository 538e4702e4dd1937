"""JSON of results and its schemas, saved runs and comparisons, tables; runs that are kept."""
