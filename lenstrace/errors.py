"""Exceptions: every mistake in a design has a class, and its message says where, what, got, what to do.

    LensTraceError (a ValueError)
    |- PrescriptionError     a file or a row that cannot be built: unknown key, missing stop, radius 0
    |- MediumError           anything about refractive indices
    |  |- UnknownGlassError    no such name in the catalogues, or no such catalogue
    |  `- WavelengthError      a wavelength outside the range a medium is known for
    |- RayError              rays that cannot be launched: an un-normalized direction, a field that is not a number
    |- LostRaysError         a question whose rays all fail
    |- ImageError            a question that needs an image, where the image is at infinity
    |- OptionError           an option of a demonstration out of its range
    |- CameraError           a picture that a lens cannot take: no real image, nearer than it can be focused
    |- DesignError           an optimization that cannot be posed: no variables, a bound that excludes the start
    `- AccuracyError         a trade or an accuracy that cannot be had

    AccuracyWarning (a UserWarning)  a result less accurate than it looks

A ray that fails inside a trace is data (`RayStatus`), never an exception.
"""


class LensTraceError(ValueError):
    """Base of all errors that lenstrace raises on purpose."""


class PrescriptionError(LensTraceError):
    """A prescription that cannot be built."""


class MediumError(LensTraceError):
    """A refractive index that cannot be given."""


class UnknownGlassError(MediumError):
    """A glass name or a catalogue that does not exist."""


class WavelengthError(MediumError):
    """A wavelength outside the range a medium is known for."""


class RayError(LensTraceError):
    """Rays that cannot be launched."""


class LostRaysError(LensTraceError):
    """A question whose rays all fail."""


class ImageError(LensTraceError):
    """A question that needs an image where there is none, because it is at infinity."""


class OptionError(LensTraceError):
    """An option of a demonstration out of its range."""


class CameraError(LensTraceError):
    """A picture that a lens cannot take: no real image, nearer than it can be focused, wider than it opens."""


class DesignError(LensTraceError):
    """A problem of design that cannot be posed: nothing to vary, nothing wanted, limits that contradict each other."""


class AccuracyError(LensTraceError):
    """A trade or an accuracy that cannot be had: a tolerance that is not positive, no setting, no design, a pupil too
    distorted for a transform."""


class AccuracyWarning(UserWarning):
    """A result that is given, but is less accurate than it looks, or not given in part: which, and what to do."""
