"""Methods to compare with: what others merge maps by, at settings that do them justice."""
