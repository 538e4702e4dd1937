"""Why an engine left the history: experiments, and the margin that decided."""
