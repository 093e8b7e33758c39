"""The exam: questions with true answers for a model, before anybody runs it for days.

::

    bank -> gathering -> ExamQuestion -> Examinee.ask -> Answered -> marks, faults -> page
"""
