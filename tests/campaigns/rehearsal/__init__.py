"""Machines of every kind in processes of their own, their runs killed and resumed, hands at them."""
