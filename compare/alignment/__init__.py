"""Whether two histories agree, and the first event at which they do not."""
