"""A client of a PALMS server in Python: be a phone, or look on.

Needs the extra ``client``. A session that loses its connection comes back by itself and sends again
what the server has not stored; nothing is applied twice.

Examples
--------
>>> client = Client("http://127.0.0.1:8000")
>>> client.socket_url
'ws://127.0.0.1:8000/api/v1/live'
"""

from palms.client.server import Client
from palms.client.session import LiveSession

__all__ = ["Client", "LiveSession"]
