"""Diagnosis of the camera from the residuals of localized pictures."""
