"""The process image of a wheel on a belt: its axes, channels, values, and the devices that fill and apply them."""
