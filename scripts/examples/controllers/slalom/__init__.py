"""A slalom on dry sand as a gymnasium environment: gymnasium.make("UgvSlalom-v0")."""

import gymnasium

gymnasium.register("UgvSlalom-v0", entry_point="controllers.slalom.environment:UgvSlalom", max_episode_steps=200)
