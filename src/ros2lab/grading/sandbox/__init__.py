"""Run programs so that they can do no harm: a World, its boxes, and what keeps them."""
