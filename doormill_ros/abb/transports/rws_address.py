"""Where a controller is reached and how it proves to be itself."""

from __future__ import annotations

import logging
import ssl
from pathlib import Path
from urllib.parse import urlsplit

from doormill_ros.abb.link_errors import CertificateError, ConnectError

_NO_CHECK_TIME = 0x200000  # X509_V_FLAG_NO_CHECK_TIME of OpenSSL, which Python gives no name
_LOG = logging.getLogger(__name__)


def tls_context(certificate: Path | None, insecure: bool) -> ssl.SSLContext:
    """Trust exactly one controller's certificate, or, when asked to, any.

    Controllers come with a self-signed certificate whose name is not the address, so the
    certificate itself is pinned instead of a name checked, whatever the clocks say of its time.

    Args:
        certificate: The controller's certificate, PEM.
        insecure: Accept every certificate; anybody on the network can then read the password.

    Raises:
        CertificateError: Neither or both are given, or the file is no certificate.
    """
    if (certificate is None) is not insecure:
        raise CertificateError(
            "give either the controller's certificate file or insecure=True; "
            "'openssl s_client -connect HOST:443 -showcerts' shows the certificate"
        )
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname = False
    if certificate is None:
        _LOG.warning("the controller's certificate is not checked: use this on a closed network only")
        context.verify_mode = ssl.CERT_NONE
        return context
    try:
        context.load_verify_locations(cafile=str(certificate))
    except (OSError, ssl.SSLError) as error:
        raise CertificateError(
            f"{certificate} is not a PEM certificate ({error}); export the controller's certificate again",
            path=str(certificate),
        ) from error
    # The file says which controller it is; the clocks of both may be wrong.
    context.verify_flags |= ssl.VERIFY_X509_PARTIAL_CHAIN | _NO_CHECK_TIME
    return context


def check_url(url: str) -> str:
    """The address of a controller without a slash at its end.

    Raises:
        ConnectError: It is not of the form http://HOST or https://HOST, or holds a password.
    """
    parts = urlsplit(url)
    if parts.scheme not in ("http", "https") or not parts.hostname:
        raise ConnectError(f"controller address is {url!r}; it must be like 'http://192.168.125.1'", url=url)
    if parts.username is not None or parts.password is not None:
        raise ConnectError(
            "controller address holds a user or password; take them out and set the environment variables "
            "of the credentials instead"
        )
    return url.rstrip("/")
