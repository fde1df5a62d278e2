"""Codes: QR codes, so that a phone finds its page."""

from __future__ import annotations

import io

from fastapi import APIRouter, Response

from palms.server import messages
from palms.server.context import Operator, problems

__all__ = ["router"]

router = APIRouter(prefix="/api/v1/codes", tags=["codes"])
BORDER = 4  # as the standard has it: light modules around a code


@router.post(
    "",
    dependencies=[Operator],
    responses={200: {"content": {"image/svg+xml": {}}}, **problems(401, 422)},
    response_class=Response,
)  # fmt: skip
async def draw_code(wanted: messages.CodeRequest) -> Response:
    """Draw a text as a QR code, an SVG. The text is in the body, since it may hold a ticket."""
    import segno

    out = io.BytesIO()
    code = segno.make_qr(wanted.text, error="m")
    code.save(out, kind="svg", border=BORDER, light="white", omitsize=True, xmldecl=False)
    return Response(out.getvalue(), media_type="image/svg+xml")
