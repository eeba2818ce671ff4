"""What leaves a ship's funnel: gases, heat and momentum, from its engine's power and its fuel."""
