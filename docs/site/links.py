# SPDX-FileCopyrightText: 2026 the trunnion authors
# SPDX-License-Identifier: BSD-3-Clause
"""links.py <site>: every link of every page leads to a file that is there, and in our own pages to a place that is there;
of places within its reference Doxygen leaves out friends and some headings, though it links to them."""

import html.parser
import os
import sys
import urllib.parse


class Page(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.links, self.places = [], set()

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("href", "src") and value:
                self.links.append(value)
            if name in ("id", "name") and value:
                self.places.add(value)


site = sys.argv[1]
pages = {}
for folder, _, files in os.walk(site):
    for file in files:
        if file.endswith(".html"):
            page = Page()
            path = os.path.join(folder, file)
            with open(path, encoding="utf-8") as text:
                page.feed(text.read())
            pages[os.path.relpath(path, site)] = page

broken, checked = [], 0
for name, page in pages.items():
    for link in page.links:
        parts = urllib.parse.urlsplit(link)
        if parts.scheme or parts.netloc or link.startswith("javascript:"):
            continue
        checked += 1
        target = os.path.normpath(os.path.join(os.path.dirname(name), urllib.parse.unquote(parts.path))) if parts.path else name
        if not os.path.exists(os.path.join(site, target)):
            broken.append(f"{name}: {link}: no such file")
        elif parts.fragment and name.startswith(("md_", "index", "usergroup", "gallery")) and target in pages and urllib.parse.unquote(parts.fragment) not in pages[target].places:
            broken.append(f"{name}: {link}: no such place")
for line in broken[:50]:
    print(line)
print(f"{len(pages)} pages, {checked} links, {len(broken)} lead nowhere")
sys.exit(bool(broken))
