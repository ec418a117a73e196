"""Real recordings with a change of our own concealed in them: what `ugv diagnose` makes of it."""
