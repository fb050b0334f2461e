"""Markers to print: tags, QR codes and boards, sheets of them, and files of exact size."""
