"""One bench a module of rtl/, run by ``make sim`` under Icarus Verilog."""
