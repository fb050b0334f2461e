"""Markers to print: tags and QR codes, sheets of them, and files of exact size."""
