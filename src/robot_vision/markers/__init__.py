"""Markers to print: tags and QR codes, sheets of them, and files as exact as a printer is."""
