"""Every picture: one style, one palette."""
