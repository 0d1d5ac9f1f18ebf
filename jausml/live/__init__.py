"""Live tools: interpreting codec, captures and listening, operating and checking components."""
