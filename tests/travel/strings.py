# SPDX-License-Identifier: Apache-2.0
"""Strings that do something where they are taken for more than text. "@@" is where the place writes which it is."""

STRINGS = {
    "HTML": b"@@<kbtag onkb=1><script>kb()</script>",
    "attribute": b"@@\" onkb=\"1\" ' onkb='1' `onkb=`1",
    "end of a script": b"@@</script></style></title></textarea><kbtag>",
    "XML": b"@@]]><kbtag/><![CDATA[ &kb; --> <?kb ?>",
    "JSON": b'@@","kb":"1"}],\\u0022 \\"',
    "terminal": b"@@\x1b[31m\x1b]0;kb\x07\r\x08",
    "C1": "@@\u009b31m\u009d0;kb\u009c\u0085".encode(),
    "no UTF-8": b"@@\xff\xfe\xc0\xaf\x9b31m\xed\xa0\x80",
    "shell": b"@@'; touch KBMARK; '\"$(touch KBMARK)`touch KBMARK`",
    "shell words": b"@@ -rf ~root * {a,b} $HOME #kb !!",
    "formula =": b"=1+1@@|cmd'!A0",
    "formula +": b"+1+1@@",
    "formula -": b"-1+1@@",
    "formula @": b"@SUM(1)@@",
    "formula tab": b"\t=1+1@@",
    "Markdown": b"@@|[kb](javascript:kb()) **kb** ![kb](http://kb.example) @kbuser #1 `kb`",
    "workflow": b"::set-output name=kb::@@",
    "workflow in the middle": b"@@##[add-mask]kb ##vso[task.kb]",
    "lines": b"@@\nPASS kb\n::set-output name=kb::x\nG01 X999",
    "comments of C and G-code": b"@@*/ int kb; /* ) G01 X999 Y999 (",
    "templates": b"@@${kb()}{{kb}}%s%n{}{0}",
    "bidirectional": "@@\u202ekb\u2066\u200b".encode(),
    "path": b"@@..",
}
# For file names: what no file can be called is left out, and what the command line refuses.
REFUSED_NAMES = ("terminal", "C1", "formula tab", "lines")


def told(text, place):
    return text.replace(b"@@", place.encode())
