"""Turns results folders of `raymeter run` into report.md, report.html and figures."""
