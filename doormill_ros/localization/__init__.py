"""Where the door stands: pictures and other sensors to a pose with its covariance, or a refusal."""
