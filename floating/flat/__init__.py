"""The event loop of the double engine: plain floats in flat lists, the general loop for what is not ordinary."""
