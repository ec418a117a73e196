"""How far the generator and the library agree, effect by effect."""
