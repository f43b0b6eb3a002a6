"""The study of columns as wave guides: what is measured on their histories, the gates on it, the declaration.

Closed forms are in `gates`; what a page says of them is in `report`.
"""
