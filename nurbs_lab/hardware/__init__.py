"""Fixed point, bit-exact twins of rtl/, simulation, timing (paper 3.2)."""
