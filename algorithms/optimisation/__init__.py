"""What is maximised, the optimisers, branch and bound, and the covariance of the best transform."""
