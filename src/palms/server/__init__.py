"""The running system: buildings, and live sessions of phones that walk in them.

`palms.server.messages` is what goes over the wire, `palms.server.application.make_application`
the whole server; `palms serve` runs it. Needs the extra ``server``, the messages do not.
"""
