"""Certificates for a secure run: an authority that lives for one run, and an identity for every process.

The authority's key is never written: nobody can join the run who was not named at its start.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime, timedelta
from ipaddress import ip_address
from pathlib import Path
from typing import Any

from bus.access import ACCESS, AUTHORITY, CERTIFICATE, OPERATOR, PRIVATE_KEY, access_control
from bus.clock import date_s
from ops.processes import RECORDER, ROUTER, SUPERVISOR, WORLD
from ops.tables import InputError

VALID = timedelta(days=30)


def issue(folder: Path, run: str, hosts: Sequence[str], names: Sequence[str]) -> Path:
    """Make an identity for the router (reachable under `hosts`), for operators, and for each of `names`, in folders of
    `folder`, readable by the owner alone. Raises `InputError` when the package for it is missing."""
    try:
        from cryptography import x509
        from cryptography.hazmat.primitives import hashes, serialization
        from cryptography.hazmat.primitives.asymmetric import ec
        from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID
    except ImportError as error:
        raise InputError("--secure: needs the package cryptography; install muster[secure]") from error

    now = datetime.fromtimestamp(date_s(), UTC)

    def certify(name: str, key: Any, issuer: str, signer: Any, *extensions: tuple[Any, bool]) -> Any:
        builder = (
            x509.CertificateBuilder()
            .subject_name(x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)]))
            .issuer_name(x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, issuer)]))
            .public_key(key.public_key())
            .serial_number(x509.random_serial_number())
            .not_valid_before(now - timedelta(hours=1))
            .not_valid_after(now + VALID)
        )
        for extension, critical in extensions:
            builder = builder.add_extension(extension, critical=critical)
        return builder.sign(signer, hashes.SHA256()).public_bytes(serialization.Encoding.PEM)

    authority = ec.generate_private_key(ec.SECP256R1())
    root = certify(run, authority, run, authority, (x509.BasicConstraints(ca=True, path_length=0), True))
    uses = x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH, ExtendedKeyUsageOID.CLIENT_AUTH])
    reached = x509.SubjectAlternativeName([_host(x509, host) for host in hosts])
    for name in (ROUTER, OPERATOR, *names):
        key = ec.generate_private_key(ec.SECP256R1())
        secret = key.private_bytes(
            serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
        )
        certificate = certify(name, key, run, authority, (uses, False), (reached, False))
        _write(folder / name, {AUTHORITY: root, CERTIFICATE: certificate, PRIVATE_KEY: secret})
    seats = (SUPERVISOR, RECORDER)
    agents = [name for name in names if name not in (*seats, WORLD)]
    rules = access_control(run, agents, seats=seats)
    _write(folder / ROUTER, {ACCESS: json.dumps(rules, indent=1).encode()})
    return folder


def _host(x509: Any, host: str) -> Any:
    try:
        return x509.IPAddress(ip_address(host))
    except ValueError:
        return x509.DNSName(host)


def _write(folder: Path, files: Mapping[str, bytes]) -> None:
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    for name, content in files.items():
        file = folder / name
        file.touch(mode=0o600)
        file.write_bytes(content)
