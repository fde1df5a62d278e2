"""Is what the voice says true? Sentences of simulated walks, judged by where the walker was."""
